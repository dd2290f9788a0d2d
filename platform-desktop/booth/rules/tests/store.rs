//! The store in memory does what every store does.

use paros_booth_rules::{MemoryStore, check_store};

#[test]
fn the_store_in_memory_is_one() {
    check_store(MemoryStore::new);
}
