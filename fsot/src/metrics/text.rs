//! The figures as aligned text.

use super::integration::PrefixError;
use super::report::{PlaneSpectrum, PointReport};
use super::tile::{Energies, FamilyEnergies, TileReport};
use crate::counted::counted;
use std::fmt::{Display, Formatter, Result};

/// A number of 4 digits; a dash where there is none.
fn number(x: f64) -> String {
    match x.abs() {
        _ if !x.is_finite() => "-".into(),
        0.0 => "0".into(),
        a if a < 1e-3 => format!("{x:.3e}"),
        a => {
            let digits = (3.0 - libm::floor(libm::log10(a))).clamp(0.0, 6.0) as usize;
            format!("{x:.digits$}")
        }
    }
}

impl Display for PointReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(f, "  {:<14}{:>12}  in {}", "points", self.points, counted(self.dims, "dimension"))?;
        let mut line =
            |name: &str, value: f64, meaning: &str| writeln!(f, "  {name:<14}{:>12}  {meaning}", number(value));
        if let [PlaneSpectrum { summary: s, .. }] = &self.spectra[..] {
            line("P_low", s.low, "mean power below half the principal frequency (random 1)")?;
            let at = number(s.peak_frequency);
            line("P_max", s.peak, &format!("peak of the radial average, at {at} principal frequencies"))?;
            line("anisotropy", s.anisotropy, "dB, mean over .5 to 2 principal frequencies (isotropic 0)")?;
        }
        if let Some(n) = &self.neighbours {
            let lattice = if self.dims == 2 { "hexagonal" } else { "densest-lattice" };
            line("NN", n.mean, &format!("mean nearest-neighbour distance, relative to the {lattice} one"))?;
            line("NN min", n.min, "smallest of them")?;
            line("NN torus", n.mean_toroidal, "mean on the torus")?;
            line("NN torus min", n.min_toroidal, "smallest on the torus")?;
        }
        if let Some(d) = &self.discrepancy {
            line("L2* e3", 1e3 * d.l2_star, "L2 star discrepancy, in thousandths")?;
            line("L2* relative", d.relative, "relative to random points' root mean square")?;
        }
        line("SW2 e3", 1e3 * self.transport.sliced_w2, "sliced Wasserstein distance to uniform, in thousandths")?;
        line("SW2 bound e3", 1e3 * self.transport.lower_bound, "what no set of as many points is below")?;
        line("SW2 shift e3", 1e3 * self.transport.shifted, "the same after random toroidal shifts")?;
        if let Some(i) = &self.integration {
            line("half-spaces", i.half_spaces, &format!("squared error over {} of them (random 1)", i.integrands))?;
            line("Gaussians", i.gaussians, &format!("squared error over {} of them (random 1)", i.integrands))?;
        }
        if self.spectra.len() > 1 {
            writeln!(f, "  spectra of pairs of coordinates, mean power below half the principal frequency, peak, dB")?;
            writeln!(f, "  {:<14}{:>12}{:>12}{:>12}", "coordinates", "P_low", "P_max", "anisotropy")?;
            for PlaneSpectrum { axes: [a, b], summary: s } in &self.spectra {
                let [low, peak, anisotropy] = [s.low, s.peak, s.anisotropy].map(number);
                writeln!(f, "  {:<14}{low:>12}{peak:>12}{anisotropy:>12}", format!("{}, {}", a + 1, b + 1))?;
            }
        }
        Ok(())
    }
}

impl Energies {
    fn columns(&self) -> String {
        let all = [self.wide, self.perceptual, self.narrow, self.raw];
        all.iter().map(|&e| format!("{:>10}", number(e))).collect()
    }
}

impl FamilyEnergies {
    fn row(&self, f: &mut Formatter<'_>, name: &str) -> Result {
        writeln!(f, "  {name:<22}{} |{}", self.half_spaces.columns(), self.gaussians.columns())
    }
}

impl Display for TileReport {
    /// A row per prefix, pair of dimensions, frame and temporal filter; columns: filters, for half-spaces and
    /// Gaussians.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let TileReport { size, spp, dims, frames, border, integrands, .. } = self;
        let many = if *frames > 1 { format!(", {frames} frames") } else { String::new() };
        let [samples, dims] = [counted(spp, "sample"), counted(dims, "dimension")];
        writeln!(f, "  tile of {size}x{size} pixels, {samples} of {dims}{many}")?;
        let [least, most] = border.map(|density| number(f64::from(density)));
        writeln!(f, "  border: {least} to {most} of a uniform density within 1/64 of an end of an axis")?;
        let integrands = counted(integrands, "integrand");
        writeln!(f, "  error energy relative to white noise (1), {integrands} of each family")?;
        let names: String = ["G2.1", "A", "G1", "raw"].iter().map(|n| format!("{n:>10}")).collect();
        writeln!(f, "  {:<22}{:>40} |{:>40}", "", "half-spaces", "Gaussians")?;
        writeln!(f, "  {:<22}{names} |{names}", "")?;
        for prefix in &self.prefixes {
            prefix.energies.row(f, &format!("{} spp", prefix.spp))?;
        }
        for marginal in &self.marginals {
            let [a, b] = marginal.axes;
            for prefix in &marginal.prefixes {
                prefix.energies.row(f, &format!("dims {}, {}: {} spp", a + 1, b + 1, prefix.spp))?;
            }
        }
        for (frame, energies) in self.per_frame.iter().enumerate() {
            energies.row(f, &format!("frame {frame}"))?;
        }
        for temporal in &self.temporal {
            temporal.energies.row(f, &format!("after EMA {}", temporal.alpha))?;
        }
        Ok(())
    }
}

/// A table of the errors of the first points of a set.
#[derive(Debug)]
pub struct PrefixTable<'a>(pub &'a [PrefixError]);

impl Display for PrefixTable<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(f, "  {:>9}{:>14}{:>12}{:>14}{:>12}", "points", "half-spaces", "relative", "Gaussians", "relative")?;
        writeln!(f, "  {:>9}{:>14}{:>12}{:>14}{:>12}", "", "RMS error", "(random 1)", "RMS error", "(random 1)")?;
        for e in self.0 {
            let [a, b, c, d] = [e.half_spaces, e.half_spaces_relative, e.gaussians, e.gaussians_relative].map(number);
            writeln!(f, "  {:>9}{a:>14}{b:>12}{c:>14}{d:>12}", e.points)?;
        }
        Ok(())
    }
}
