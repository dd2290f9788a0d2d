//! Mutation of inputs: a few random changes of bits, numbers, words and stretches.

use paros_models::random_visitor::RandomSource;

/// Boundary values of integers.
const EDGES: [i64; 12] =
    [0, 1, -1, 2, 127, 128, 255, 256, i32::MAX as i64, i32::MIN as i64, u32::MAX as i64, i64::MAX];

/// Returns a new input derived from a corpus, of at most `longest` bytes. `words` is the dictionary of
/// tokens.
pub fn mutate(
    dice: &mut RandomSource,
    corpus: &[Vec<u8>],
    words: &[&[u8]],
    longest: usize,
) -> Vec<u8> {
    let mut bytes = pick(dice, corpus).cloned().unwrap_or_default();
    for _ in 0..1 + below_power_of_two(dice, 4) {
        match dice.below(10) {
            0 => change_byte(dice, &mut bytes),
            1 => flip_bit(dice, &mut bytes),
            2 => add_to_number(dice, &mut bytes),
            3 => write_edge(dice, &mut bytes),
            4 => replace_written_number(dice, &mut bytes),
            5 => insert_word(dice, &mut bytes, words),
            6 => delete_stretch(dice, &mut bytes),
            7 => repeat_stretch(dice, &mut bytes),
            8 => copy_within(dice, &mut bytes),
            _ => join_with(dice, &mut bytes, corpus),
        }
    }
    bytes.truncate(longest);
    bytes
}

fn pick<'a, T>(dice: &mut RandomSource, from: &'a [T]) -> Option<&'a T> {
    if from.is_empty() { None } else { from.get(dice.below(from.len() as u64) as usize) }
}

/// Returns a number below a random power of two, so that small numbers are as likely as large ones.
fn below_power_of_two(dice: &mut RandomSource, powers: u64) -> u64 {
    let power = dice.below(powers);
    dice.below(1 << power)
}

fn place(dice: &mut RandomSource, bytes: &[u8]) -> usize {
    dice.below(bytes.len() as u64 + 1) as usize
}

/// Returns a range of bytes; short ranges are as likely as long ones.
fn stretch(dice: &mut RandomSource, bytes: &[u8]) -> std::ops::Range<usize> {
    let start = place(dice, bytes);
    let length = below_power_of_two(dice, 9) as usize + 1;
    start..(start + length).min(bytes.len())
}

fn change_byte(dice: &mut RandomSource, bytes: &mut [u8]) {
    let at = place(dice, bytes);
    if let Some(byte) = bytes.get_mut(at) {
        *byte = dice.next_bits() as u8;
    }
}

fn flip_bit(dice: &mut RandomSource, bytes: &mut [u8]) {
    let at = place(dice, bytes);
    if let Some(byte) = bytes.get_mut(at) {
        *byte ^= 1 << dice.below(8);
    }
}

/// Adds a small value to a number of one, two, four or eight bytes.
fn add_to_number(dice: &mut RandomSource, bytes: &mut [u8]) {
    let (at, width) = (place(dice, bytes), 1 << dice.below(4));
    if let Some(number) = bytes.get_mut(at..at + width) {
        let mut value = [0; 8];
        value[..width].copy_from_slice(number);
        let sum = u64::from_le_bytes(value).wrapping_add(dice.below(33)).wrapping_sub(16);
        number.copy_from_slice(&sum.to_le_bytes()[..width]);
    }
}

fn write_edge(dice: &mut RandomSource, bytes: &mut [u8]) {
    let (at, width) = (place(dice, bytes), 1 << dice.below(4));
    let mut value = EDGES[dice.below(EDGES.len() as u64) as usize].to_le_bytes();
    if dice.one_in(4) {
        value[..width].reverse();
    }
    if let Some(number) = bytes.get_mut(at..at + width) {
        number.copy_from_slice(&value[..width]);
    }
}

/// Replaces a decimal number.
fn replace_written_number(dice: &mut RandomSource, bytes: &mut Vec<u8>) {
    let from = place(dice, bytes);
    let Some(start) = bytes[from..].iter().position(u8::is_ascii_digit).map(|i| from + i) else {
        return;
    };
    let length = bytes[start..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let edge = EDGES[dice.below(EDGES.len() as u64) as usize];
    let number = if dice.one_in(2) { edge } else { dice.below(20) as i64 - 5 };
    bytes.splice(start..start + length, number.to_string().bytes());
}

fn insert_word(dice: &mut RandomSource, bytes: &mut Vec<u8>, words: &[&[u8]]) {
    let at = place(dice, bytes);
    let word = pick(dice, words).map_or_else(|| vec![dice.next_bits() as u8], |word| word.to_vec());
    // Inserts the word, or overwrites bytes with it.
    let over = if dice.one_in(2) { word.len().min(bytes.len() - at) } else { 0 };
    bytes.splice(at..at + over, word);
}

fn delete_stretch(dice: &mut RandomSource, bytes: &mut Vec<u8>) {
    let range = stretch(dice, bytes);
    bytes.drain(range);
}

fn repeat_stretch(dice: &mut RandomSource, bytes: &mut Vec<u8>) {
    let range = stretch(dice, bytes);
    let copy = bytes[range.clone()].repeat(1 + dice.below(4) as usize);
    bytes.splice(range.end..range.end, copy);
}

fn copy_within(dice: &mut RandomSource, bytes: &mut [u8]) {
    let range = stretch(dice, bytes);
    let to = dice.below((bytes.len() - range.len()) as u64 + 1) as usize;
    bytes.copy_within(range, to);
}

/// Joins a prefix of this input with a suffix of another.
fn join_with(dice: &mut RandomSource, bytes: &mut Vec<u8>, corpus: &[Vec<u8>]) {
    if let Some(other) = pick(dice, corpus) {
        bytes.truncate(place(dice, bytes));
        bytes.extend_from_slice(&other[place(dice, other)..]);
    }
}
