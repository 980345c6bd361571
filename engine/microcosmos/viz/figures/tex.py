"""Text as LaTeX takes it, with the letters that pdfLaTeX knows."""

THIN = "\u202f"
"""A narrow space."""

SAID = {
    THIN: r"\,",
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "%": r"\%",
    "&": r"\&",
    "#": r"\#",
    "$": r"\$",
    "_": r"\_",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "²": r"$^2$",
    "³": r"$^3$",
    "×": r"$\times$",
    "·": r"$\cdot$",
    "ν": r"$\nu$",
    "−": r"$-$",
    "…": r"\ldots{}",
    "’": "'",
}


def latex(text: str) -> str:
    """The same words, every special letter escaped; others stay, as UTF-8."""
    text = text.replace(" %", THIN + "%")
    return "".join(SAID.get(letter, letter) for letter in text)
