"""The ROS 2 shell: message in, pure step, message out."""
