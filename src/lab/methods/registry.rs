//! All methods by their names.

use super::Solve;

/// A method as the command line names it.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Lower case, with hyphens.
    pub name: &'static str,
    /// What it does, and where it comes from.
    pub about: &'static str,
    /// Which laws its answers obey exactly, and what becomes of the others.
    pub laws: &'static str,
    /// The method.
    pub solve: Solve,
}

impl Method {
    /// All there are.
    pub const ALL: &'static [Method] = &[
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

    /// The one of that name.
    pub fn by_name(name: &str) -> Option<&'static Method> {
        Method::ALL.iter().find(|method| method.name == name)
    }
}
