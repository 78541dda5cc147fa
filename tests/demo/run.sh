#!/usr/bin/env bash
# The demonstration: signs sample surfaces, stores them, searches them, maps and matches them, and
# leaves a gallery of pictures with their numbers: OUT/index.html.
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

# The gallery: each section is a picture with the command that drew it and what that printed.
gallery="$out/index.html"
escaped() { sed -e 's/&/\&amp;/g' -e 's/</\&lt;/g' -e 's/>/\&gt;/g'; }
cat >"$gallery" <<'HTML'
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>moduli: gallery</title>
<style>
body { max-width: 75rem; margin: 2rem auto; padding: 0 1rem; color: #1a1a1a; font: 16px/1.5 sans-serif; }
section { margin: 3rem 0; }
h2 { margin: 0; font-size: 1.2rem; }
img { width: 100%; height: auto; }
pre { margin: 0; padding: 0.8rem; overflow-x: auto; background: #f2f4f6; font-size: 13px; line-height: 1.4; }
nav a { margin-right: 1rem; }
</style>
</head>
<body>
<h1>moduli: gallery</h1>
<p>Each picture with the command that drew it, and what it printed.</p>
HTML
show() { # show TITLE PICTURE SENTENCE COMMAND...: runs moduli COMMAND --picture PICTURE
  local title=$1 picture=$2 sentence=$3 printed
  shift 3
  say "$title"
  printed=$("$moduli" "$@" --picture "$out/$picture")
  printf '%s\n' "$printed"
  {
    # Titles on the terminal are numbered steps.
    title=${title#*. }
    printf '<section id="%s">\n<h2>%s</h2>\n' "${picture%.*}" "$(printf '%s' "$title" | escaped)"
    printf '<p>%s</p>\n' "$(printf '%s' "$sentence" | escaped)"
    printf '<a href="%s"><img src="%s" alt="%s" loading="lazy"></a>\n' "$picture" "$picture" \
      "$(printf '%s' "$title" | escaped)"
    printf '<pre>$ moduli %s\n\n' "$(printf '%s ' "$@" "--picture $picture" | sed "s|$out/||g" | escaped)"
    printf '%s</pre>\n</section>\n' "$(printf '%s' "$printed" | sed "s|$out/||g" | escaped)"
  } >>"$gallery"
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
sample plates/square plate holes=0 resolution=8
sample plates/disk disk resolution=16
for step in 3 4 6; do sample "plates/two-holes-$step" plate holes=2 hole_step=$step resolution=6; done
ls "$out"/meshes/*

say "2. What is in a mesh: moduli inspect"
"$moduli" inspect "$out/meshes/tori/torus-2.ply"

say "3. Its signature: a torus with radii 2 and 1 has tau = i sqrt 3 = 1.732... i"
"$moduli" signature "$out/meshes/tori/torus-2.ply"

say "4. All of them into a collection: moduli add"
"$moduli" add -c demo --recursive "$out/meshes" --label-from dir
"$moduli" list -c demo

show "5. Search by shape: who looks like a capsule?" search-capsule.png \
  "The nearest shapes of a collection, by the distance of their curvatures." \
  search -c demo "$out/meshes/spheres/capsule-0.5.ply" -k 6

show "6. Search by conformal structure: which tori have the angles of the Clifford torus?" \
  search-clifford.png "Tori are told apart by tau alone; how they are bent does not matter." \
  search -c demo "$out/meshes/tori/clifford.ply" --space conformal -k 6

say "7. A pretzel has a matrix of periods, and energies that no choice of loops changes"
"$moduli" signature "$out/meshes/pretzels/genus-2.ply" --space conformal
"$moduli" search -c demo "$out/meshes/pretzels/genus-2-remeshed.ply" --space conformal -k 3

say "8. A ring with radii 1 and 5 has the modulus log 5 / (2 pi) = 0.2561..."
"$moduli" signature "$out/meshes/plates/ring-5.ply" --space conformal

show "9. Plates with two holes, by the periods of their doubles" search-plates.png \
  "A surface with a boundary has the periods of itself glued to its mirror image." \
  search -c demo "$out/meshes/plates/two-holes-4.ply" --space conformal -k 3

show "10. To the sphere" map-sphere.png \
  "A closed surface without handles. Folded faces would be red; there are none." \
  parameterize "$out/meshes/spheres/ellipsoid.ply" --to sphere -o "$out/sphere.obj"
show "11. To the disk" map-unit-disk.png \
  "A surface with one boundary loop: a square, its centre in the middle." \
  parameterize "$out/meshes/plates/square.ply" --to disk -o "$out/unit-disk.obj"
show "12. To a rectangle" map-rectangle.png \
  "A disk with four corners, a quarter turn apart: the width at height 1 is its modulus, 1." \
  parameterize "$out/meshes/plates/disk.ply" --to rectangle --corners 721,745,769,793 -o "$out/rectangle.obj"
show "13. To a disk with round holes" map-circles.png \
  "A surface with several boundary loops." \
  parameterize "$out/meshes/plates/two-holes-4.ply" --to circle-domain -o "$out/circles.obj"
show "14. A torus and its copies in the plane" map-torus.png \
  "One cell of the lattice, cut along its two generators; its copies fill the plane." \
  parameterize "$out/meshes/tori/diplotorus.ply" --to torus -o "$out/torus.obj"
show "15. To the plane, with cones" map-flat.png \
  "The cones are chosen to take the stretching out, and the surface is cut open through them." \
  parameterize "$out/meshes/spheres/spheroid-2.ply" --to flat --cones auto --seamless -o "$out/flat.obj"
show "16. How much longer lengths become" map-scale.png \
  "The same map by its scale." \
  parameterize "$out/meshes/spheres/spheroid-2.ply" --to flat --cones auto --seamless --draw scale
show "17. How far faces are from keeping their angles" map-dilatation.png \
  "The same map by its dilatation: 1 where a small circle stays one." \
  parameterize "$out/meshes/spheres/spheroid-2.ply" --to flat --cones auto --seamless --draw dilatation
show "18. Islands and seams" map-layout.png \
  "The same map by its seams: both sides of one have its colour." \
  parameterize "$out/meshes/spheres/spheroid-2.ply" --to flat --cones auto --seamless --draw layout
show "19. As a surface of cubes" map-polycube.png \
  "Flat but for corners of a quarter turn: convex ones magenta, concave ones teal." \
  parameterize "$out/meshes/spheres/capsule-1.5.ply" --to polycube -o "$out/polycube.obj"
show "20. An affine atlas" map-atlas.png \
  "Flat but for one extraordinary point; every other vertex has a chart, and charts change by motions." \
  parameterize "$out/meshes/pretzels/genus-2.ply" --to atlas --atlas "$out/atlas.json" -o "$out/atlas.obj"
show "21. Squares from a form with whole periods" map-quads.png \
  "The lines of the unit squares go on across every cut." \
  parameterize "$out/meshes/tori/torus-2.ply" --to quads --most-squares 600 -o "$out/quads.obj"
show "22. In the Poincaré disk" map-disk.png \
  "A surface with two handles, by its metric of curvature -1, with its shortest closed geodesics." \
  parameterize "$out/meshes/pretzels/genus-2.ply" --to hyperbolic -o "$out/disk.obj"

show "23. Where is each point of a surface on another one?" match-ellipsoids.png \
  "Two triangulations of one ellipsoid; what corresponds has one colour." \
  match "$out/meshes/spheres/ellipsoid.ply" "$out/meshes/spheres/ellipsoid-remeshed.ply" \
  -o "$out/map.csv"
head -4 "$out/map.csv"

show "24. Down the valley along affine normals" minimize-rosenbrock.png \
  "Rosenbrock's function: level sets, their affine normals, and the path to the minimum at (1, 1)." \
  minimize rosenbrock --start -1.2,1 --trace "$out/rosenbrock.csv"
printf '</body>\n</html>\n' >>"$gallery"

say "Done. Look at $gallery, or at the pictures themselves:"
ls "$out"/*.png
