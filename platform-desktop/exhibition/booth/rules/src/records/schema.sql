-- The tables of the records, for SQLite. For PostgreSQL the words of the types are replaced, and STRICT is removed.

CREATE TABLE devices (
    headset INTEGER NOT NULL PRIMARY KEY,
    token_hash BLOB NOT NULL,
    hint BLOB NOT NULL,
    name TEXT NOT NULL,
    enrolled_at INTEGER NOT NULL,
    revoked_at INTEGER,
    wiped_at INTEGER,
    seen_at INTEGER,
    status BLOB NOT NULL
) STRICT;
CREATE INDEX devices_token_hash ON devices (token_hash);
CREATE INDEX devices_hint ON devices (hint);

CREATE TABLE enrol_tokens (
    token_hash BLOB NOT NULL PRIMARY KEY,
    note TEXT NOT NULL,
    expires_at INTEGER NOT NULL,
    uses_left INTEGER NOT NULL,
    is_revoked INTEGER NOT NULL
) STRICT;

CREATE TABLE commands (
    headset INTEGER NOT NULL,
    command INTEGER NOT NULL,
    boot INTEGER NOT NULL,
    session INTEGER NOT NULL,
    kind INTEGER NOT NULL,
    asked_at INTEGER NOT NULL,
    state INTEGER NOT NULL,
    PRIMARY KEY (headset, command)
) STRICT;

CREATE TABLE announcements (
    headset INTEGER NOT NULL,
    sculpture BLOB NOT NULL,
    badge INTEGER,
    heard_at INTEGER NOT NULL,
    status INTEGER NOT NULL,
    PRIMARY KEY (headset, sculpture)
) STRICT;
CREATE INDEX announcements_badge ON announcements (badge);
CREATE INDEX announcements_sculpture ON announcements (sculpture);

CREATE TABLE badge_blocks (
    block INTEGER NOT NULL PRIMARY KEY,
    headset INTEGER NOT NULL,
    serial BLOB NOT NULL,
    epoch INTEGER NOT NULL,
    next INTEGER,
    leased_at INTEGER NOT NULL,
    free_on INTEGER
) STRICT;
CREATE INDEX badge_blocks_headset ON badge_blocks (headset);
CREATE INDEX badge_blocks_free_on ON badge_blocks (free_on);

CREATE TABLE badge_cursor (
    row INTEGER NOT NULL PRIMARY KEY,
    turn INTEGER NOT NULL,
    day INTEGER NOT NULL,
    left_today INTEGER NOT NULL,
    closed_until INTEGER NOT NULL,
    copied_at INTEGER,
    is_used_up INTEGER NOT NULL,
    swept_on INTEGER NOT NULL,
    restored_at INTEGER NOT NULL
) STRICT;

CREATE TABLE sculptures (
    id BLOB NOT NULL PRIMARY KEY,
    headset INTEGER NOT NULL,
    hash BLOB NOT NULL,
    badge INTEGER,
    claimed_badge INTEGER,
    pictures INTEGER NOT NULL,
    language BLOB NOT NULL,
    mode INTEGER NOT NULL,
    facts BLOB NOT NULL,
    received_at INTEGER NOT NULL,
    keep_day INTEGER NOT NULL,
    withdrawn_at INTEGER,
    has_trace INTEGER NOT NULL,
    export INTEGER NOT NULL,
    link_generation INTEGER NOT NULL,
    is_link_revoked INTEGER NOT NULL
) STRICT;
CREATE INDEX sculptures_badge ON sculptures (badge);
-- Has all that lists are filtered by, so that SQLite counts and skips rows without reading them.
CREATE INDEX sculptures_list ON sculptures
    (received_at, id, withdrawn_at, headset, language, mode, pictures, badge);
CREATE INDEX sculptures_export ON sculptures (export);
CREATE INDEX sculptures_keep_day ON sculptures (keep_day);
CREATE UNIQUE INDEX sculptures_claimed_badge ON sculptures (claimed_badge);

CREATE TABLE tombstones (
    id BLOB NOT NULL PRIMARY KEY,
    headset INTEGER NOT NULL,
    hash BLOB NOT NULL,
    badge INTEGER,
    deleted_at INTEGER NOT NULL,
    ends_on INTEGER NOT NULL,
    has_files INTEGER NOT NULL
) STRICT;
CREATE INDEX tombstones_badge ON tombstones (badge);
CREATE INDEX tombstones_ends_on ON tombstones (ends_on);

CREATE TABLE accounts (
    name TEXT NOT NULL PRIMARY KEY,
    password_hash TEXT NOT NULL,
    role INTEGER NOT NULL,
    is_disabled INTEGER NOT NULL
) STRICT;

CREATE TABLE staff_sessions (
    token_hash BLOB NOT NULL PRIMARY KEY,
    account TEXT NOT NULL,
    form_token BLOB NOT NULL,
    used_at INTEGER NOT NULL,
    expires_at INTEGER NOT NULL
) STRICT;
CREATE INDEX staff_sessions_account ON staff_sessions (account);

CREATE TABLE mail_orders (
    "order" INTEGER NOT NULL PRIMARY KEY,
    sculpture BLOB NOT NULL,
    address TEXT,
    language INTEGER NOT NULL,
    asked_at INTEGER NOT NULL,
    state INTEGER NOT NULL,
    tries INTEGER NOT NULL,
    next_try_at INTEGER NOT NULL,
    why TEXT NOT NULL,
    keeps_address INTEGER NOT NULL
) STRICT;
CREATE INDEX mail_orders_sculpture ON mail_orders (sculpture);
CREATE INDEX mail_orders_state ON mail_orders (state);

CREATE TABLE audit (
    at INTEGER NOT NULL,
    number INTEGER NOT NULL,
    account TEXT,
    action TEXT NOT NULL,
    headset INTEGER,
    sculpture BLOB,
    badge INTEGER,
    PRIMARY KEY (at, number)
) STRICT;
CREATE INDEX audit_sculpture ON audit (sculpture);

CREATE TABLE print_orders (
    "order" INTEGER NOT NULL PRIMARY KEY,
    sculpture BLOB NOT NULL,
    height_tenths_mm INTEGER NOT NULL,
    filament TEXT NOT NULL,
    note TEXT NOT NULL,
    asked_at INTEGER NOT NULL,
    state INTEGER NOT NULL,
    most_minutes INTEGER,
    estimate INTEGER NOT NULL,
    minutes INTEGER,
    tenths_gram INTEGER,
    printer TEXT,
    job TEXT,
    changed_at INTEGER NOT NULL,
    why TEXT NOT NULL
) STRICT;
CREATE INDEX print_orders_sculpture ON print_orders (sculpture);
CREATE INDEX print_orders_state ON print_orders (state);

CREATE TABLE seen_time (
    row INTEGER NOT NULL PRIMARY KEY,
    seen_at INTEGER NOT NULL
) STRICT;

CREATE TABLE work_leases (
    kind INTEGER NOT NULL,
    subject BLOB NOT NULL,
    worker INTEGER NOT NULL,
    until INTEGER NOT NULL,
    PRIMARY KEY (kind, subject)
) STRICT;
