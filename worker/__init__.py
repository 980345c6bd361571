"""Takes runs from the queue and carries them out; the renderer of creatures too."""
