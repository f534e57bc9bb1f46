//! Decodes the recording that lies in the board's memory and says what that took.
//!
//! Standard output has six accelerations a sample, as they lie in memory: a, m/s^2, and w*', rad/s^2, ground axes.
//! Standard error has one line of figures by name, which `.ci/microcontroller` reads.
#![no_std]
#![no_main]

use core::arch::asm;
use core::fmt::Write;
use core::hint::black_box;
use core::slice;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::register::msp;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hio};
use sixaxis_core::{Decoupler, LIMBS};
use sixaxis_microcontroller::{Number, prepare};

/// What the emulator has loaded: this, then the rows.
#[repr(C)]
struct Recording {
    sample_rate_hz: f64,
    samples: u64,
}

/// Where; above what memory.x gives the program.
const RECORDING: *const Recording = 0x10_0000 as *const Recording;

/// Turns of the loop of two instructions that the clock is compared with.
const TURNS: u32 = 1_000_000;

/// Any of the things that end the program early.
struct Failed;

#[entry]
fn main() -> ! {
    let status = match run() {
        Ok(()) => debug::EXIT_SUCCESS,
        Err(Failed) => debug::EXIT_FAILURE,
    };
    loop {
        debug::exit(status);
    }
}

fn run() -> Result<(), Failed> {
    // SAFETY: loaded there by whoever started the program, aligned; nobody writes to it.
    let (recording, rows) = unsafe {
        let recording = &*black_box(RECORDING);
        let rows = RECORDING.add(1).cast::<[Number; LIMBS]>();
        (
            recording,
            slice::from_raw_parts(rows, recording.samples as usize),
        )
    };
    let mut clock = cortex_m::Peripherals::take().ok_or(Failed)?.SYST;
    let known_ticks = ticks(&mut clock, || known_loop(TURNS))?;

    let mut decoupler = None;
    let prepare_stack = stack(|| decoupler = prepare(recording.sample_rate_hz).ok());
    let mut decoupler = decoupler.ok_or(Failed)?;
    let mut again = decoupler.clone();

    // The first answer comes with the third row, another way than all others.
    let (first, rest) = rows.split_at_checked(3).ok_or(Failed)?;
    push_each(&mut decoupler, first)?;
    let mut pushed = Err(Failed);
    let mut push_ticks = Err(Failed);
    let push_stack = stack(|| {
        push_ticks = ticks(&mut clock, || pushed = push_each(&mut decoupler, rest));
    });
    pushed?;

    let mut out = hio::hstdout().map_err(|()| Failed)?;
    for row in rows {
        if let Some(answer) = again.push(row).map_err(|_| Failed)? {
            let (a, w) = (answer.linear_ground_m_s2, answer.angular_ground_rad_s2);
            for number in [a.x, a.y, a.z, w.x, w.y, w.z] {
                out.write_all(&number.to_le_bytes()).map_err(|()| Failed)?;
            }
        }
    }
    let mut figures = hio::hstderr().map_err(|()| Failed)?;
    writeln!(
        figures,
        "known_instructions {} known_ticks {known_ticks} samples {} push_ticks {} decoupler_bytes {} \
         prepare_stack_bytes {prepare_stack} push_stack_bytes {push_stack}",
        2 * TURNS,
        rest.len(),
        push_ticks?,
        size_of::<Decoupler<Number>>(),
    )
    .map_err(|_| Failed)
}

/// What is counted: a sample in memory, a call of `push`, the answer in memory.
#[inline(never)]
fn push_each(decoupler: &mut Decoupler<Number>, rows: &[[Number; LIMBS]]) -> Result<(), Failed> {
    for row in rows {
        black_box(&decoupler.push(black_box(row)).map_err(|_| Failed)?);
    }
    Ok(())
}

/// Two instructions a turn.
fn known_loop(turns: u32) {
    // SAFETY: registers of its own.
    unsafe {
        asm!("2: subs {0}, #1", "bne 2b", inout(reg) turns => _, options(nomem, nostack));
    }
}

/// Ticks of the system timer while `work` runs; it counts down from 2^24.
#[inline(never)]
fn ticks(clock: &mut SYST, work: impl FnOnce()) -> Result<u32, Failed> {
    const TOP: u32 = 0xff_ffff;
    clock.set_clock_source(SystClkSource::Core);
    clock.set_reload(TOP);
    clock.clear_current();
    clock.enable_counter();
    // It starts with the next tick, at the top.
    while SYST::get_current() == 0 {}
    clock.has_wrapped();
    let start = SYST::get_current();
    work();
    let end = SYST::get_current();
    if clock.has_wrapped() {
        return Err(Failed);
    }
    Ok(start - end)
}

/// The most bytes of stack that `work` uses: how deep a pattern below the stack pointer is overwritten.
#[inline(never)]
fn stack(work: impl FnOnce()) -> usize {
    const PATTERN: u32 = 0xa5c3_5a3c;
    const WORDS: usize = 1 << 14;
    let top = msp::read() as *mut u32;
    // SAFETY: the stack's memory below all that is on it, and far more of it than this.
    let lowest = unsafe { top.sub(WORDS) };
    for i in 0..WORDS {
        // SAFETY: as above; this function calls nothing while it writes there.
        unsafe { lowest.add(i).write_volatile(PATTERN) };
    }
    below(work);
    // SAFETY: as above.
    let untouched = (0..WORDS).take_while(|&i| unsafe { lowest.add(i).read_volatile() } == PATTERN);
    4 * (WORDS - untouched.count())
}

/// What `work` keeps on the stack is below its caller's.
#[inline(never)]
fn below(work: impl FnOnce()) {
    work();
}
