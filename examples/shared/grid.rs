//! Pictures of characters.

/// Rows of characters around a middle, blank at first.
pub(crate) struct Grid {
    width: i64,
    height: i64,
    cells: Vec<char>,
}

impl Grid {
    /// *Domain* both are above zero.
    pub(crate) fn new(width: i64, height: i64) -> Self {
        Self { width, height, cells: vec![' '; (width * height) as usize] }
    }

    /// Puts a sign so many columns to the right of the middle and so many rows above it; nowhere if that is outside.
    pub(crate) fn put(&mut self, right: i64, up: i64, sign: char) {
        let (column, row) = (right + self.width / 2, self.height / 2 - up);
        if (0..self.width).contains(&column) && (0..self.height).contains(&row) {
            self.cells[(row * self.width + column) as usize] = sign;
        }
    }

    /// The rows from the top, without blanks at their ends.
    pub(crate) fn rows(&self) -> impl Iterator<Item = String> {
        self.cells.chunks(self.width as usize).map(|row| row.iter().collect::<String>().trim_end().to_owned())
    }
}
