"""The claims that the program rests on, each computed and held against its source."""
