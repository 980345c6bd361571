"""Text for LaTeX."""

THIN = "\u202f"
"""A narrow space."""

ESCAPES = {
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
    "<": "$<$",
    ">": "$>$",
    "≥": r"$\geq$",
    "…": r"\ldots{}",
    "’": "'",
}


def latex(text: str) -> str:
    """Return the text as one line for LaTeX: special letters escaped, others as UTF-8."""
    # A line break would end a comment (test_latex_is_a_booktabs_table_of_escaped_words).
    text = " ".join(text.splitlines()).replace(" %", THIN + "%")
    return "".join(ESCAPES.get(letter, letter) for letter in text)
