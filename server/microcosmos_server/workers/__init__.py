"""Workers: their registry, and the plug-ins that they offer."""
