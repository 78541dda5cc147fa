#!/usr/bin/env bash
# The demonstration: signs sample surfaces, stores them, searches them, leaves pictures.
# usage: run.sh BIN OUT      BIN holds moduli; OUT is made anew.
set -eu
bin=$1
out=$2
moduli="$bin/moduli"

rm -rf "$out"
mkdir -p "$out/meshes/spheres" "$out/meshes/tori" "$out/meshes/pretzels" "$out/meshes/plates"
export MODULI_DATA="$out/store"
unset MODULI_SERVER

say() { printf '\n\033[1m%s\033[0m\n' "$*"; }
sample() { # sample CLASS/NAME KIND k=v...
  local name=$1
  shift
  "$moduli" --quiet sample "$@" -o "$out/meshes/$name.ply"
}

say "1. Sample surfaces"
sample spheres/round sphere resolution=24
for c in 0.5 0.75 1.5 2; do sample "spheres/spheroid-$c" spheroid a=1 c=$c resolution=24; done
sample spheres/ellipsoid ellipsoid a=1 b=1.3 c=1.8 resolution=24
sample spheres/ellipsoid-remeshed ellipsoid a=1 b=1.3 c=1.8 resolution=20 seed=5
for l in 0.5 1.5; do sample "spheres/capsule-$l" capped-cylinder radius=1 half_length=$l resolution=24; done
for R in 1.3 1.6 2 3; do sample "tori/torus-$R" torus R=$R r=1 resolution=32; done
sample tori/clifford torus R=1.4142135623730951 r=1 resolution=40 seed=7
sample tori/diplotorus diplotorus n=6 phi=0.03 h=0.6 s=-2 s2=0 resolution=6
for g in 2 3; do sample "pretzels/genus-$g" genus genus=$g resolution=8; done
sample pretzels/genus-2-remeshed genus genus=2 resolution=8 seed=5
for R in 2 5; do sample "plates/ring-$R" annulus r=1 R=$R resolution=16; done
for step in 3 4 6; do sample "plates/two-holes-$step" plate holes=2 hole_step=$step resolution=6; done
ls "$out"/meshes/*

say "2. What is in a mesh: moduli inspect"
"$moduli" inspect "$out/meshes/tori/torus-2.ply"

say "3. Its signature: a torus with radii 2 and 1 has tau = i sqrt 3 = 1.732... i"
"$moduli" signature "$out/meshes/tori/torus-2.ply"

say "4. All of them into a collection: moduli add"
"$moduli" add -c demo --recursive "$out/meshes" --label-from dir
"$moduli" list -c demo

say "5. Search by shape: who looks like a capsule?"
"$moduli" search -c demo "$out/meshes/spheres/capsule-0.5.ply" -k 6 --picture "$out/search-capsule.png"

say "6. Search by conformal structure: which tori have the angles of the Clifford torus?"
"$moduli" search -c demo "$out/meshes/tori/clifford.ply" --space conformal -k 6 \
  --picture "$out/search-clifford.png"

say "7. A pretzel has a matrix of periods, and energies that no choice of loops changes"
"$moduli" signature "$out/meshes/pretzels/genus-2.ply" --space conformal
"$moduli" search -c demo "$out/meshes/pretzels/genus-2-remeshed.ply" --space conformal -k 3

say "8. A ring with radii 1 and 5 has the modulus log 5 / (2 pi) = 0.2561..."
"$moduli" signature "$out/meshes/plates/ring-5.ply" --space conformal

say "9. Plates with two holes, by the periods of their doubles"
"$moduli" search -c demo "$out/meshes/plates/two-holes-4.ply" --space conformal -k 3 \
  --picture "$out/search-plates.png"

say "10. Maps without a fold: to the sphere, to a disk with round holes, to the plane"
"$moduli" parameterize "$out/meshes/spheres/ellipsoid.ply" --to sphere -o "$out/sphere.obj" \
  --picture "$out/map-sphere.png"
"$moduli" parameterize "$out/meshes/plates/two-holes-4.ply" --to circle-domain \
  -o "$out/circles.obj" --picture "$out/map-circles.png"
"$moduli" parameterize "$out/meshes/tori/torus-2.ply" --to flat -o "$out/flat.obj" \
  --picture "$out/map-flat.png"

say "11. A pretzel, cut open, in the Poincaré disk, with its shortest closed geodesics"
"$moduli" parameterize "$out/meshes/pretzels/genus-2.ply" --to hyperbolic -o "$out/disk.obj" \
  --picture "$out/map-disk.png"

say "12. Where is each point of a surface on another one? Two triangulations of one ellipsoid"
"$moduli" match "$out/meshes/spheres/ellipsoid.ply" "$out/meshes/spheres/ellipsoid-remeshed.ply" \
  -o "$out/map.csv" --picture "$out/match-ellipsoids.png"
head -4 "$out/map.csv"

say "Done. Look at:"
ls "$out"/*.png
