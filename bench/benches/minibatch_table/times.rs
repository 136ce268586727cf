//! Nanoseconds of a draw and of an update.

use crate::methods::{BATCH, Method};
use noisefloor::rng::Rng;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// One method's times, a pair for each chunk: nanoseconds of a draw and of an update.
pub(crate) type Times = Vec<(f64, f64)>;

pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// What is read to empty the caches.
pub(crate) struct Memory(Vec<u64>);

impl Memory {
    /// 64 MB.
    pub(crate) fn new() -> Self {
        Self(vec![1; 8 << 20])
    }

    /// A word of each cache line.
    fn read(&self) {
        black_box(self.0.iter().step_by(8).sum::<u64>());
    }
}

/// Steps of a chunk, for each method.
pub(crate) struct Chunks<'a> {
    pub(crate) count: usize,
    pub(crate) steps: &'a [usize],
    /// Read before each draw and before each update.
    pub(crate) cold: Option<&'a Memory>,
}

/// Chunks of steps by each method in turn. A chunk's figures are the medians of its steps': a step during which another
/// program ran does not count. As many steps before them, which are not timed, bring the table back into the caches.
pub(crate) fn measure(methods: &mut [Box<dyn Method>], chunks: &Chunks) -> Vec<Times> {
    let mut rng = Rng::seed(2);
    let mut times: Vec<Times> = methods.iter().map(|_| Times::default()).collect();
    for chunk in 0..=chunks.count {
        for ((method, &steps), times) in methods.iter_mut().zip(chunks.steps).zip(&mut times) {
            let warm_up = if chunks.cold.is_some() { 0 } else { steps };
            let (mut draws, mut updates) = (Vec::with_capacity(steps), Vec::with_capacity(steps));
            for step in 0..warm_up + steps {
                let (draw, update) = time(method.as_mut(), &mut rng, chunks.cold);
                if step >= warm_up {
                    draws.push(draw);
                    updates.push(update);
                }
            }
            // The first chunk finds caches and predictors of other work.
            if chunk > 0 {
                times.push((median(&mut draws), median(&mut updates)));
            }
        }
    }
    times
}

/// Time of day; or processor time, for what takes so long that other programs run meanwhile.
struct Clock {
    start: Instant,
    processor: Option<Duration>,
}

impl Clock {
    fn start(slow: bool) -> Self {
        let processor = if slow { processor_time() } else { None };
        Self { start: Instant::now(), processor }
    }

    fn elapsed(&self) -> Duration {
        match (self.processor, self.processor.and_then(|_| processor_time())) {
            (Some(before), Some(after)) => after - before,
            _ => self.start.elapsed(),
        }
    }
}

/// Of this thread. Asking takes a fraction of a microsecond.
#[cfg(unix)]
fn processor_time() -> Option<Duration> {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the one pointer is to a value of the type that the function writes.
    let status = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    (status == 0).then(|| Duration::new(time.tv_sec as u64, time.tv_nsec as u32))
}

#[cfg(not(unix))]
fn processor_time() -> Option<Duration> {
    None
}

/// One step.
fn time(method: &mut dyn Method, rng: &mut Rng, cold: Option<&Memory>) -> (f64, f64) {
    let importance = std::array::from_fn(|_| rng.uniform_f32());
    let (mut index, mut weight) = ([0; BATCH], [0.0; BATCH]);
    cold.inspect(|memory| memory.read());
    let start = Instant::now();
    method.draw(black_box(&mut index), &mut weight);
    let drawn = start.elapsed();
    // What a step learns is known later: its items have left the caches again.
    cold.inspect(|memory| memory.read());
    let start = Clock::start(method.updates_slowly());
    method.update(black_box(&index), &importance);
    let updated = start.elapsed();
    black_box(&weight);
    let nanoseconds = |time: Duration| time.as_secs_f64() * 1e9 / BATCH as f64;
    (nanoseconds(drawn), nanoseconds(updated))
}

/// Nanoseconds per item to add a constant to all importances; None where the table cannot.
pub(crate) fn add_epsilon(method: &mut dyn Method, items: u32) -> Option<f64> {
    let mut times = Vec::new();
    for _ in 0..21 {
        let start = Instant::now();
        if !method.add_epsilon() {
            return None;
        }
        times.push(start.elapsed().as_secs_f64() * 1e9 / f64::from(items));
    }
    Some(median(&mut times))
}
