"""What the joints do: pure functions of phase and amplitude."""
