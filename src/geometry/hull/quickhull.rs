//! Convex hulls of points that do not lie in one plane: Barber, Dobkin and Huhdanpaa, "The Quickhull Algorithm for Convex
//! Hulls" (ACM TOMS 22, 1996), with exact signs, so that it needs no tolerance, merges no facets and leaves no point out.
//!
//! What of a closed convex surface is strictly visible from a point is one patch with one simple loop around it, and with
//! exact signs this holds for the computed surface too. A point that saw a facet of the patch sees one of the new
//! facets or is inside: across the edge of the patch where its own patch ends, the new facet lies between the two old ones.

use nalgebra::{Point3, Vector3};

use super::orientation::height;
use crate::error::{Error, ErrorKind, Result};

/// The most signs that are computed for one hull: seconds, not minutes. Meshes of robots take a few millions; only point
/// sets made for it come near.
const MOST_SIGNS: u64 = 400_000_000;

/// No facet, no point.
const NONE: u32 = u32::MAX;

struct Facet {
    /// Counterclockwise from outside.
    vertices: [u32; 3],
    /// Facet beyond the edge from vertex i to vertex i + 1.
    beyond: [u32; 3],
    /// Of the facet's plane, rounded, of no particular length: for choosing, not for deciding.
    normal: Vector3<f64>,
    /// Points that are strictly above, each kept by one facet only.
    outside: Vec<u32>,
    alive: bool,
}

pub(super) struct Quickhull<'a> {
    points: &'a [Point3<f64>],
    facets: Vec<Facet>,
    /// Places of dead facets, to be used again.
    free: Vec<u32>,
    /// By point: the new facet that begins at it.
    begins: Vec<u32>,
    signs: u64,
}

impl<'a> Quickhull<'a> {
    /// The hull of `points`, no two of them equal, `simplex` four of them that are not in one plane.
    ///
    /// # Errors
    /// When it takes too long.
    pub(super) fn new(points: &'a [Point3<f64>], simplex: [u32; 4]) -> Result<Self> {
        let mut hull = Self {
            points,
            facets: Vec::new(),
            free: Vec::new(),
            begins: vec![NONE; points.len()],
            signs: 0,
        };
        let [a, mut b, mut c, d] = simplex;
        if hull.above([a, b, c], d) {
            std::mem::swap(&mut b, &mut c);
        }
        // d is below a, b, c. Facet i is opposite to corner i, and across each of its edges lies the opposite of a corner.
        for (vertices, beyond) in [
            ([b, d, c], [2, 1, 3]),
            ([a, c, d], [3, 0, 2]),
            ([a, d, b], [1, 0, 3]),
            ([a, b, c], [2, 0, 1]),
        ] {
            hull.push(vertices, beyond);
        }
        let all: Vec<u32> = (0..points.len() as u32)
            .filter(|p| !simplex.contains(p))
            .collect();
        hull.distribute(all, &[0, 1, 2, 3])?;
        hull.grow()?;
        Ok(hull)
    }

    /// The facets, counterclockwise from outside.
    pub(super) fn facets(&self) -> Vec<[u32; 3]> {
        let alive = self.facets.iter().filter(|f| f.alive);
        alive.map(|f| f.vertices).collect()
    }

    /// Whether each point is a corner of the hull: at least three planes meet there. Others lie on edges and faces between
    /// corners that came later.
    pub(super) fn corners(&self) -> Vec<bool> {
        let mut creases = vec![0_u8; self.points.len()];
        for facet in self.facets.iter().filter(|f| f.alive) {
            for (i, beyond) in facet.beyond.iter().enumerate() {
                let other = &self.facets[*beyond as usize].vertices;
                let bent = other
                    .iter()
                    .any(|p| !facet.vertices.contains(p) && self.height(facet.vertices, *p) != 0.0);
                if bent {
                    let creases = &mut creases[facet.vertices[i] as usize];
                    *creases = creases.saturating_add(1);
                }
            }
        }
        creases.iter().map(|n| *n >= 3).collect()
    }

    fn point(&self, index: u32) -> &Point3<f64> {
        &self.points[index as usize]
    }

    fn height(&self, [a, b, c]: [u32; 3], p: u32) -> f64 {
        height(self.point(a), self.point(b), self.point(c), self.point(p))
    }

    fn above(&mut self, facet: [u32; 3], p: u32) -> bool {
        self.signs += 1;
        self.height(facet, p) > 0.0
    }

    fn push(&mut self, vertices: [u32; 3], beyond: [u32; 3]) -> u32 {
        let [a, b, c] = vertices.map(|v| self.point(v));
        let facet = Facet {
            vertices,
            beyond,
            normal: (b - a).cross(&(c - a)),
            outside: Vec::new(),
            alive: true,
        };
        if let Some(place) = self.free.pop() {
            self.facets[place as usize] = facet;
            place
        } else {
            self.facets.push(facet);
            (self.facets.len() - 1) as u32
        }
    }

    /// Gives each point to the first of `facets` that it is above; points above none are inside.
    fn distribute(&mut self, points: Vec<u32>, facets: &[u32]) -> Result<()> {
        for p in points {
            for f in facets {
                if self.above(self.facets[*f as usize].vertices, p) {
                    self.facets[*f as usize].outside.push(p);
                    break;
                }
            }
            if self.signs > MOST_SIGNS {
                return Err(Error::new(
                    ErrorKind::Infeasible,
                    "the convex hull has too many corners",
                )
                .help("simplify the mesh"));
            }
        }
        Ok(())
    }

    /// Takes outside points into the hull until there are none.
    fn grow(&mut self) -> Result<()> {
        let mut waiting: Vec<u32> = (0..self.facets.len() as u32).collect();
        let (mut patch, mut rim, mut fresh) = (Vec::new(), Vec::new(), Vec::new());
        while let Some(start) = waiting.pop() {
            let Some(apex) = self.farthest(start) else {
                continue;
            };
            self.see(start, apex, &mut patch, &mut rim);
            fresh.clear();
            for &(facet, edge) in &rim {
                let Facet {
                    vertices, beyond, ..
                } = &self.facets[facet as usize];
                let (from, to, there) = (vertices[edge], vertices[(edge + 1) % 3], beyond[edge]);
                let new = self.push([from, to, apex], [there, NONE, NONE]);
                let there = &mut self.facets[there as usize];
                if let Some(back) = there.vertices.iter().position(|v| *v == to) {
                    there.beyond[back] = new;
                }
                if std::mem::replace(&mut self.begins[from as usize], new) != NONE {
                    return Err(torn());
                }
                fresh.push(new);
            }
            for new in &fresh {
                let to = self.facets[*new as usize].vertices[1];
                let next = self.begins[to as usize];
                self.facets[*new as usize].beyond[1] = next;
                let next = self.facets.get_mut(next as usize).ok_or_else(torn)?;
                next.beyond[2] = *new;
            }
            for new in &fresh {
                self.begins[self.facets[*new as usize].vertices[0] as usize] = NONE;
            }
            let mut orphans = Vec::new();
            for facet in patch.drain(..) {
                orphans.append(&mut self.facets[facet as usize].outside);
                self.free.push(facet);
            }
            orphans.retain(|p| *p != apex);
            self.distribute(orphans, &fresh)?;
            waiting.extend(&fresh);
        }
        Ok(())
    }

    /// The outside point of a facet that is highest above it: most of the time a corner of the hull.
    fn farthest(&self, facet: u32) -> Option<u32> {
        let facet = &self.facets[facet as usize];
        let foot = self.point(facet.vertices[0]);
        let far = |p: &u32| facet.normal.dot(&(self.point(*p) - foot));
        let outside = facet.outside.iter().copied().filter(|_| facet.alive);
        outside.max_by(|p, q| far(p).total_cmp(&far(q)))
    }

    /// Collects the facets that are visible from `apex`, beginning with `start`, as dead, and the edges around them, each
    /// with the dead facet inside.
    fn see(&mut self, start: u32, apex: u32, patch: &mut Vec<u32>, rim: &mut Vec<(u32, usize)>) {
        rim.clear();
        patch.push(start);
        self.facets[start as usize].alive = false;
        let mut next = 0;
        while let Some(&facet) = patch.get(next) {
            next += 1;
            for edge in 0..3 {
                let there = self.facets[facet as usize].beyond[edge];
                if !self.facets[there as usize].alive {
                    continue;
                }
                if self.above(self.facets[there as usize].vertices, apex) {
                    self.facets[there as usize].alive = false;
                    patch.push(there);
                } else {
                    rim.push((facet, edge));
                }
            }
        }
    }
}

/// Cannot be while signs are exact; said rather than believed.
pub(super) fn torn() -> Error {
    Error::new(ErrorKind::Infeasible, "the surface of the convex hull tore")
        .help("simplify the mesh")
}
