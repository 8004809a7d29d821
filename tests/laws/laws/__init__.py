"""Laws that hold for every scene: how its answers change where the scene is written another way."""
