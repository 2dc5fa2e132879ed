"""What the ground answers: kinematics and quasi-static force balance of planar chains."""
