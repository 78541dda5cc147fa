-- Share of the true nearest shapes that searches of the collection are to find, between 0 and 1; NULL
-- for all of them: exact search. Changing it is a change of kind 4 (shape_id 0).
ALTER TABLE collections ADD COLUMN wanted_recall REAL;
