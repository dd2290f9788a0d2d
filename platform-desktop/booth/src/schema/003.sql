ALTER TABLE mail_orders ADD COLUMN keeps_address INTEGER NOT NULL DEFAULT 0;
CREATE INDEX audit_sculpture ON audit (sculpture);
CREATE INDEX audit_at ON audit (at);
