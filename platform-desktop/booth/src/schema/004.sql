ALTER TABLE print_orders ADD COLUMN most_minutes INTEGER;
ALTER TABLE print_orders ADD COLUMN estimate INTEGER NOT NULL DEFAULT 2;
ALTER TABLE print_orders ADD COLUMN minutes INTEGER;
ALTER TABLE print_orders ADD COLUMN tenths_gram INTEGER;
ALTER TABLE print_orders ADD COLUMN printer TEXT;
ALTER TABLE print_orders ADD COLUMN job TEXT;
ALTER TABLE print_orders ADD COLUMN changed_at INTEGER NOT NULL DEFAULT 0;
ALTER TABLE print_orders ADD COLUMN why TEXT NOT NULL DEFAULT '';

CREATE TABLE block_grants (
    block INTEGER NOT NULL,
    first_place INTEGER NOT NULL,
    headset INTEGER NOT NULL,
    PRIMARY KEY (block, first_place)
) STRICT;
