-- Collections of signed shapes. Times are microseconds since 1970-01-01 UTC.

CREATE TABLE collections (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name TEXT NOT NULL UNIQUE,
  create_time INTEGER NOT NULL,
  shape_count INTEGER NOT NULL DEFAULT 0
) STRICT;

-- AUTOINCREMENT: a number, once given, is never given again. Indexes and replicas rely on it.
CREATE TABLE shapes (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  collection_id INTEGER NOT NULL REFERENCES collections (id),
  name TEXT NOT NULL,
  label TEXT NOT NULL,
  digest TEXT NOT NULL,
  format TEXT NOT NULL,
  file_name TEXT NOT NULL,
  create_time INTEGER NOT NULL,
  mesh_bytes INTEGER NOT NULL,
  type TEXT NOT NULL,
  genus INTEGER NOT NULL,
  boundary_loops INTEGER NOT NULL,
  vertices INTEGER NOT NULL,
  faces INTEGER NOT NULL,
  area REAL NOT NULL,
  descriptor_version INTEGER NOT NULL,
  UNIQUE (collection_id, name)
) STRICT;
CREATE INDEX shapes_by_digest ON shapes (digest);
CREATE INDEX shapes_by_version ON shapes (descriptor_version);

CREATE TABLE tags (
  shape_id INTEGER NOT NULL REFERENCES shapes (id) ON DELETE CASCADE,
  key TEXT NOT NULL,
  value TEXT NOT NULL,
  PRIMARY KEY (shape_id, key)
) STRICT, WITHOUT ROWID;

-- Serialized moduli.v1.Signature; apart from the shapes so that lists do not read it.
CREATE TABLE signatures (
  shape_id INTEGER PRIMARY KEY REFERENCES shapes (id) ON DELETE CASCADE,
  bytes BLOB NOT NULL
) STRICT;

-- Little-endian float32. space as in moduli.v1.Signature.Space: 1 conformal, 2 metric, 3 shape.
CREATE TABLE vectors (
  shape_id INTEGER NOT NULL REFERENCES shapes (id) ON DELETE CASCADE,
  space INTEGER NOT NULL,
  bytes BLOB NOT NULL,
  PRIMARY KEY (shape_id, space)
) STRICT, WITHOUT ROWID;

-- What happened, in order, so that indexes catch up. kind: 1 shape added, 2 shape removed,
-- 3 collection removed (shape_id 0). Old rows are forgotten, the newest never.
CREATE TABLE changes (
  sequence INTEGER PRIMARY KEY AUTOINCREMENT,
  kind INTEGER NOT NULL,
  collection_id INTEGER NOT NULL,
  shape_id INTEGER NOT NULL
) STRICT;

-- Successes to repeat to a caller that asks again with the same request_id.
CREATE TABLE requests (
  request_id TEXT PRIMARY KEY,
  collection_id INTEGER NOT NULL,
  collection_name TEXT NOT NULL,
  create_time INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
