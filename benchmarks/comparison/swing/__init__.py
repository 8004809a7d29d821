"""The swing: a soft round rod, clamped horizontally, swings down in its plane for a second."""
