"""Figures for print, of archive files: the map, curves, the contact sheet, the tree.

`drawing` makes them from files to files; `reading.read` with `maps.archive`, `curves.curves`,
`sheet.sheet` and `lineage.lineage`, within `style.styled()`, makes them in a notebook.
"""
