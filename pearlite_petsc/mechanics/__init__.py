"""Springs, kinematics, loads and linear elastic fracture mechanics (pure numpy)."""
