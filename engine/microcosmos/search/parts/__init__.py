"""Parts: optional behaviours of the search loop, one file each."""

from . import breeding, containers, initial, lessons, records, reevaluation, screening
