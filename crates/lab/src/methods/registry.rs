//! All methods by their names.

use super::Solve;

/// A method as the command line names it.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Lower case, with hyphens.
    pub name: &'static str,
    /// What it does, and where it comes from.
    pub about: &'static str,
    /// Which laws its solutions obey exactly, and how the others are treated.
    pub laws: &'static str,
    /// The method.
    pub solve: Solve,
}

/// The laws of the exact methods.
const EXACT: &str = "bounds, cone and patches; pyramid and box if asked for; dense, for some hundred rows";

impl Method {
    /// All there are.
    pub const ALL: &'static [Method] = &[
        Method {
            name: "lemke",
            about: "complementary pivoting, ties by the lexicographic rule (Lemke 1965)",
            laws: EXACT,
            solve: super::lemke,
        },
        Method {
            name: "dantzig",
            about: "principal pivoting row by row between bounds (Cottle and Dantzig 1968; Baraff 1994)",
            laws: EXACT,
            solve: super::dantzig,
        },
        Method {
            name: "keller",
            about: "symmetric principal pivoting with blocks of one and two (Keller 1973)",
            laws: EXACT,
            solve: super::keller,
        },
        Method {
            name: "murty",
            about: "principal pivoting by the least index (Murty 1974)",
            laws: EXACT,
            solve: super::murty,
        },
        Method {
            name: "block-pivoting",
            about: "all violated rows at once, by the least index where that stalls (J\u{fa}dice and Pires \
                1994)",
            laws: EXACT,
            solve: super::block_pivoting,
        },
        Method {
            name: "newton-min",
            about: "Newton's method on the minimum map (Pang 1990)",
            laws: EXACT,
            solve: super::newton_min,
        },
        Method {
            name: "newton-fb",
            about: "Newton's method on Fischer and Burmeister's function, for contacts on Alart and \
                Curnier's (1991)",
            laws: EXACT,
            solve: super::newton_fb,
        },
        Method {
            name: "path",
            about: "path search between points of the normal map (Ralph 1994; Dirkse and Ferris 1995)",
            laws: EXACT,
            solve: super::path,
        },
        Method {
            name: "jacobi",
            about: "projected Jacobi, with steps by row sums (Cottle, Pang and Stone 1992)",
            laws: "bounds, cone and patches; pyramid and box if asked for",
            solve: super::jacobi,
        },
        Method {
            name: "pgs",
            about: "projected Gauss-Seidel, a row at a time: sequential impulses (Catto 2005)",
            laws: "bounds, cone and patches; pyramid and box if asked for",
            solve: super::pgs,
        },
        Method {
            name: "psor",
            about: "projected successive over-relaxation (Cryer 1971)",
            laws: "bounds, cone and patches; pyramid and box if asked for",
            solve: super::psor,
        },
        Method {
            name: "gs-cone",
            about: "block Gauss-Seidel with exact contacts (Jean and Moreau 1992)",
            laws: "bounds, cone and patches",
            solve: super::gs_cone,
        },
        Method {
            name: "nncg",
            about: "nonsmooth nonlinear conjugate gradients on gs-cone (Silcowitz, Niebe and Erleben 2010)",
            laws: "bounds, cone and patches",
            solve: super::nncg,
        },
        Method {
            name: "apgd",
            about: "accelerated projected gradients with De Saxcé's shift (Mazhar et al. 2015)",
            laws: "bounds, cone and patches, for symmetric W",
            solve: super::apgd,
        },
        Method {
            name: "admm",
            about: "alternating directions with one Cholesky factor per penalty (Carpentier et al. 2024)",
            laws: "bounds, cone and patches",
            solve: super::admm,
        },
        Method {
            name: "prox",
            about: "proximal fixed point with a step of its own for each law (Erleben 2017)",
            laws: "bounds, cone and patches",
            solve: super::prox,
        },
    ];

    /// The method with that name.
    pub fn by_name(name: &str) -> Option<&'static Method> {
        Method::ALL.iter().find(|method| method.name == name)
    }
}
