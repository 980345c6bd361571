/** Texts of exports. */

export const text = {
  about: "The last checkpoint, in formats that other programs read.",
  real: "For SI units in Parquet, Arrow and netCDF: real length of a body and time of a stroke",
  preparing: "Preparing …",
  formats: {
    parquet: ["Parquet", "Tables for pandas, polars and R (ZIP)"],
    arrow: ["Arrow", "The same tables, uncompressed, to be mapped into memory (ZIP)"],
    netcdf: ["netCDF", "The archive over its axes, for xarray"],
    alife: ["ALife CSV", "The phylogeny in the ALife data standard"],
    newick: ["Newick", "The phylogeny as trees by first parents"],
    "ro-crate": [
      "RO-Crate",
      "Everything with checksums, citation and the command that repeats it, for Zenodo (ZIP)",
    ],
  } as const,
};
