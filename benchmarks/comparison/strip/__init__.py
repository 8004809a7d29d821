"""The strip: clamped askew, so that it leaves its plane and twists as it falls for a second."""
