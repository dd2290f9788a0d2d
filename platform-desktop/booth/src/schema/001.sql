CREATE TABLE devices (
    headset INTEGER NOT NULL,
    token_hash BLOB NOT NULL,
    hint BLOB NOT NULL,
    name TEXT NOT NULL,
    enrolled_at INTEGER NOT NULL,
    revoked_at INTEGER,
    wiped_at INTEGER,
    seen_at INTEGER,
    status BLOB NOT NULL,
    PRIMARY KEY (headset)
) STRICT;
CREATE INDEX devices_token_hash ON devices (token_hash);
CREATE INDEX devices_hint ON devices (hint);

CREATE TABLE enrol_tokens (
    token_hash BLOB NOT NULL,
    note TEXT NOT NULL,
    expires_at INTEGER NOT NULL,
    uses_left INTEGER NOT NULL,
    is_revoked INTEGER NOT NULL,
    PRIMARY KEY (token_hash)
) STRICT;

CREATE TABLE enrol_attempts (
    attempt INTEGER NOT NULL,
    commitment BLOB NOT NULL,
    hint BLOB NOT NULL,
    name TEXT NOT NULL,
    booth_nonce BLOB NOT NULL,
    began_at INTEGER NOT NULL,
    state INTEGER NOT NULL,
    token_hash BLOB,
    pictograms BLOB,
    headset INTEGER,
    PRIMARY KEY (attempt)
) STRICT;
CREATE INDEX enrol_attempts_hint ON enrol_attempts (hint);

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
    state INTEGER NOT NULL,
    PRIMARY KEY (headset, sculpture)
) STRICT;
CREATE INDEX announcements_badge ON announcements (badge);

CREATE TABLE ledger (
    row INTEGER NOT NULL,
    bytes BLOB NOT NULL,
    PRIMARY KEY (row)
) STRICT;

CREATE TABLE sculptures (
    id BLOB NOT NULL,
    headset INTEGER NOT NULL,
    hash BLOB NOT NULL,
    badge INTEGER,
    claim INTEGER NOT NULL,
    facts BLOB NOT NULL,
    received_at INTEGER NOT NULL,
    keep_day INTEGER NOT NULL,
    is_in_ledger INTEGER NOT NULL,
    withdrawn_at INTEGER,
    has_trace INTEGER NOT NULL,
    export INTEGER NOT NULL,
    link_generation INTEGER NOT NULL,
    is_link_revoked INTEGER NOT NULL,
    PRIMARY KEY (id)
) STRICT;
CREATE INDEX sculptures_badge ON sculptures (badge);
CREATE INDEX sculptures_received_at ON sculptures (received_at);
CREATE INDEX sculptures_export ON sculptures (export);
CREATE INDEX sculptures_keep_day ON sculptures (keep_day);
CREATE INDEX sculptures_is_in_ledger ON sculptures (is_in_ledger);

CREATE TABLE tombstones (
    id BLOB NOT NULL,
    headset INTEGER NOT NULL,
    hash BLOB NOT NULL,
    badge INTEGER,
    deleted_at INTEGER NOT NULL,
    ends_on INTEGER NOT NULL,
    has_files INTEGER NOT NULL,
    PRIMARY KEY (id)
) STRICT;
CREATE INDEX tombstones_badge ON tombstones (badge);
CREATE INDEX tombstones_ends_on ON tombstones (ends_on);

CREATE TABLE accounts (
    name TEXT NOT NULL,
    password_hash TEXT NOT NULL,
    role INTEGER NOT NULL,
    is_disabled INTEGER NOT NULL,
    PRIMARY KEY (name)
) STRICT;

CREATE TABLE staff_sessions (
    token_hash BLOB NOT NULL,
    account TEXT NOT NULL,
    form_token BLOB NOT NULL,
    used_at INTEGER NOT NULL,
    expires_at INTEGER NOT NULL,
    PRIMARY KEY (token_hash)
) STRICT;
CREATE INDEX staff_sessions_account ON staff_sessions (account);

CREATE TABLE mail_orders (
    "order" INTEGER NOT NULL,
    sculpture BLOB NOT NULL,
    address TEXT,
    language INTEGER NOT NULL,
    asked_at INTEGER NOT NULL,
    state INTEGER NOT NULL,
    tries INTEGER NOT NULL,
    next_try_at INTEGER NOT NULL,
    PRIMARY KEY ("order")
) STRICT;
CREATE INDEX mail_orders_sculpture ON mail_orders (sculpture);
CREATE INDEX mail_orders_state ON mail_orders (state);

CREATE TABLE print_orders (
    "order" INTEGER NOT NULL,
    sculpture BLOB NOT NULL,
    height_tenths_mm INTEGER NOT NULL,
    filament TEXT NOT NULL,
    note TEXT NOT NULL,
    asked_at INTEGER NOT NULL,
    state INTEGER NOT NULL,
    PRIMARY KEY ("order")
) STRICT;
CREATE INDEX print_orders_sculpture ON print_orders (sculpture);
CREATE INDEX print_orders_state ON print_orders (state);

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
