//! Continuous collision: nothing is crossed by speed, and slow scenes do not pay.

mod classic;
mod fair;
mod shots;
