"""How wave amplitudes yield: admittance law and external torque."""
