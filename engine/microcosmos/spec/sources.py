"""Sources of the methods, for the schemas and the reference."""

PAPER = "Tensen et al. 2026"
OURS = "ours: docs/physics.md"
NEAT = "Stanley and Miikkulainen, Evol. Comput. 10, 99 (2002)"
CPPN = "Stanley, Genet. Program. Evolvable Mach. 8, 131 (2007)"
MAP_ELITES = "Mouret and Clune, arXiv:1504.04909 (2015)"
TOURNAMENT = "tournament: Goldberg and Deb, Foundations of Genetic Algorithms 1, 69 (1991)"
CURIOSITY = "curiosity: Cully and Demiris, IEEE Trans. Evol. Comput. 22, 245 (2018)"
PHASE_LAG = "Ijspeert, Neural Networks 21, 642 (2008)"
CVT = "Vassiliades, Chatzilygeroudis and Mouret, IEEE Trans. Evol. Comput. 22, 623 (2018)"
LINE = "Vassiliades and Mouret, GECCO 2018, eq. 3"
CMA_ME = "Fontaine et al., GECCO 2020"
CMA_MAE = "Fontaine and Nikolaidis, GECCO 2023"
CMA_MEGA = "Fontaine and Nikolaidis, NeurIPS 2021, algorithm 2"
OMG_MEGA = "slopes as in OMG-MEGA: Fontaine and Nikolaidis, NeurIPS 2021"
REEVALUATION = "Flageat and Cully, Artificial Life 32 (2020) and arXiv:2302.00463"
ADAPTIVE = "Justesen, Risi and Mouret, GECCO 2019 Companion, 121"
STANDARD_ERROR = "Di Pietro, While and Barone, CEC 2004, 1254"
LATTICE = "D2Q9: " + PAPER
TRT = "Ginzburg, Verhaeghe and d’Humières, Commun. Comput. Phys. 3, 427 (2008)"
GUO = "Guo, Zheng and Shi, Phys. Rev. E 65, 046308 (2002), eqs. 3, 4 and 20"
FORCING = "Wang, Fan and Luo, Int. J. Multiphase Flow 34, 283 (2008)"
PBD = "Müller et al., J. Vis. Commun. Image R. 18, 109 (2007)"
RODS = "planar form of " + PAPER + "; Umetani, Schmidt and Stam, SCA 2014"
LAYERS = "Mittal and Iaccarino, Annu. Rev. Fluid Mech. 37, 239 (2005), as in " + PAPER
DELTAS = (
    "peskin: Acta Numerica 11, 479 (2002), eq. 6.27; roma: J. Comput. Phys. 153, 509 (1999), "
    "eq. 22"
)
ADAM = "Kingma and Ba, ICLR 2015, algorithm 1"
DIGITS = "Alpaydin and Kaynak, UCI (1998), doi:10.24432/C50P49"
BANDIT = (
    "Cully, GECCO 2021; UCB1: Auer, Cesa-Bianchi and Fischer, Mach. Learn. 47, 235 (2002); "
    "window: Garivier and Moulines, arXiv:0805.3415"
)
MOME = (
    "Pierrot, Richard, Beguir and Cully, GECCO 2022, arXiv:2202.03057; crowding: Janmohamed, "
    "Pierrot and Cully, GECCO 2023, arXiv:2302.12668"
)
DOMINATED_NOVELTY = "Bahlous-Boldi et al., GECCO 2025, arXiv:2502.00593"
AURORA = "Grillotti and Cully, IEEE Trans. Evol. Comput. 26, 1539 (2022), arXiv:2106.05648"
SCREENING = "Gaier, Asteroth and Mouret, Evol. Comput. 26, 381 (2018)"
BREEDING = (
    "Picbreeder: Secretan et al., Evol. Comput. 19, 373 (2011); review: Takagi, Proc. IEEE 89, "
    "1275 (2001)"
)
