"""Figures for print, of archive files: the map, curves, the contact sheet, the tree."""
