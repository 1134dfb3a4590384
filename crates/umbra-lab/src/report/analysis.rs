//! Conclusions from the runs: orders, floors, costs, the cheapest way to an error.

use umbra_physics::Integrator;

use super::data::{Line, Measured, Order, Results};

/// Errors in two scalars that differ by less than this share are those of the integrator.
const SAME: f64 = 0.05;

/// The order that two lines of the same integrator show: the slope over the finest two successive rates at which
/// both scalars err alike, so that it is not rounding that is seen.
pub(crate) fn order(a: &[Measured], b: &[Measured]) -> Option<Order> {
    let alike: Vec<Option<f64>> = a.iter().zip(b).map(|(a, b)| same(a.error?, b.error?)).collect();
    let pairs = alike.windows(2).zip(a.windows(2)).rev();
    pairs.into_iter().find_map(|(errors, runs)| {
        let (from_rate, to_rate) = (runs[0].rate, runs[1].rate);
        let slope = (errors[0]? / errors[1]?).ln() / (f64::from(to_rate) / f64::from(from_rate)).ln();
        Some(Order { slope, from_rate, to_rate })
    })
}

/// The slope over all rates at which both scalars err alike, by least squares. Where in a step bodies meet is chance: between two rates
/// the error of an impact may fall by anything.
pub(crate) fn trend(a: &[Measured], b: &[Measured]) -> Option<Order> {
    let alike = |(a, b): (&Measured, &Measured)| Some((a.rate, same(a.error?, b.error?)?.ln()));
    let points: Vec<(u32, f64)> = a.iter().zip(b).filter_map(alike).collect();
    let (&(from_rate, _), &(to_rate, _)) = (points.first()?, points.last()?);
    let count = points.len() as f64;
    let log = |rate: u32| f64::from(rate).ln();
    let middle = points.iter().map(|&(rate, _)| log(rate)).sum::<f64>() / count;
    let along = points.iter().map(|&(rate, error)| (log(rate) - middle) * error).sum::<f64>();
    let square = points.iter().map(|&(rate, _)| (log(rate) - middle).powi(2)).sum::<f64>();
    (from_rate < to_rate).then(|| Order { slope: -along / square, from_rate, to_rate })
}

fn same(a: f64, b: f64) -> Option<f64> {
    (a > 0.0 && (a - b).abs() < SAME * a).then_some(a)
}

impl Results {
    pub(crate) fn line(&self, integrator: Integrator, scalar: &str) -> Option<&Line> {
        self.lines.iter().find(|line| line.integrator == integrator && line.scalar == scalar)
    }

    /// The least error that a scalar reaches with any integrator, and with which.
    pub(crate) fn least(&self, scalar: &str) -> Option<f64> {
        let lines = self.lines.iter().filter(|line| line.scalar == scalar);
        lines.flat_map(|line| &line.runs).filter_map(|run| run.error).min_by(f64::total_cmp)
    }

    /// The ratios of the time that steps take in fx to that in another scalar, by integrator at the highest rate.
    pub(crate) fn cost_of_fixed_point(&self, beside: &str) -> Vec<f64> {
        let last = |integrator, scalar| self.line(integrator, scalar)?.runs.last().map(|run| run.cost);
        let ratio = |integrator| Some(last(integrator, "fx")? / last(integrator, beside)?);
        Integrator::ALL.into_iter().filter_map(ratio).collect()
    }

    /// The first rate at which an integrator errs more than twice as much in a scalar as in f64.
    pub(crate) fn end_of(&self, scalar: &str, integrator: Integrator) -> Option<u32> {
        let (line, double) = (self.line(integrator, scalar)?, self.line(integrator, "f64")?);
        let worse =
            line.runs.iter().zip(&double.runs).find(
                |(run, twin)| matches!((run.error, twin.error), (Some(error), Some(twin_error)) if error > 2.0 * twin_error),
            );
        worse.map(|(run, _)| run.rate)
    }

    /// The cheapest run in a scalar that errs by no more than this, where the next finer one does not either: a run may
    /// be right by chance.
    pub(crate) fn cheapest(&self, scalar: &str, error: f64) -> Option<(Integrator, Measured)> {
        let within = |run: &Measured| run.error.is_some_and(|run_error| run_error <= error);
        let of_line = |line: &Line| {
            let first = (0..line.runs.len()).find(|&i| line.runs[i..].iter().take(2).all(within))?;
            Some((line.integrator, line.runs[first]))
        };
        let lines = self.lines.iter().filter(|line| line.scalar == scalar);
        lines.filter_map(of_line).min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))
    }
}

/// The value in the middle of all; none of none.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(errors: &[f64]) -> Vec<Measured> {
        let run = |(i, &error): (usize, &f64)| Measured { rate: 10 << i, error: Some(error), cost: f64::from(1 << i) };
        errors.iter().enumerate().map(run).collect()
    }

    #[test]
    fn the_order_is_taken_where_scalars_agree() {
        let (fine, coarse) = (runs(&[1.0, 0.25, 0.0625, 0.01]), runs(&[1.0, 0.25, 0.0626, 0.02]));
        assert_eq!(order(&fine, &coarse), Some(Order { slope: 2.0, from_rate: 20, to_rate: 40 }));
        assert_eq!(order(&fine, &runs(&[0.5; 4])), None);
    }

    #[test]
    fn the_trend_is_taken_over_all_rates_where_scalars_agree() {
        // Rates 10 to 160, the last without agreement: a slope of 1 with an error up and one down beside it.
        let (fine, coarse) = (runs(&[1.0, 1.0, 0.125, 0.125, 0.01]), runs(&[1.0, 1.0, 0.126, 0.125, 0.02]));
        let order = trend(&fine, &coarse).expect("four rates");
        assert_eq!((order.from_rate, order.to_rate), (10, 80));
        // Σ x·y / Σ x² for x = -1.5, -0.5, 0.5, 1.5 octaves and y = 0, 0, -3, -3.
        assert!((order.slope - 6.0 / 5.0).abs() < 1e-12, "{}", order.slope);
        assert_eq!(trend(&fine, &runs(&[1.0, 5.0, 5.0, 5.0, 5.0])), None);
    }

    #[test]
    fn a_run_that_is_right_by_chance_is_not_the_cheapest() {
        let line = |integrator, errors: &[f64]| Line { integrator, scalar: "fx", order: None, runs: runs(errors) };
        let results = Results {
            name: "",
            title: "",
            about: "",
            has_contacts: false,
            unit: "m",
            seconds: 1,
            reference_error: 0.0,
            lines: vec![
                line(Integrator::SymplecticEuler, &[1e-9, 0.5, 1e-3, 1e-4]),
                line(Integrator::VelocityVerlet, &[1.0, 0.01, 1e-3, 1e-4]),
            ],
        };
        let cheapest = results.cheapest("fx", 0.02).map(|(integrator, run)| (integrator, run.rate));
        assert_eq!(cheapest, Some((Integrator::VelocityVerlet, 20)));
        assert_eq!(results.cheapest("fx", 1e-5), None);
    }
}
