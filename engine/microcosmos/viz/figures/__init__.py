"""Figures for print of archive files: map, curves, contact sheet, tree.

`drawing` makes files from files. In a notebook, use `reading.read` with `maps.archive`,
`curves.curves`, `sheet.sheet` and `lineage.lineage` within `style.styled()`.
"""
