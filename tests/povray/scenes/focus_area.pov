// Fruit in a bowl and a candlestick, through a lens, under a panel: lens (u, v), light (u, v).
#include "stack.inc"
#include "woods.inc"

Lens_camera(<1.6, 3.0, -7.2>, <0.15, 0.75, -1.1>, 32, 0.26, U_0, U_1)
Panel_point(<4.6, 5.6, -0.6>, <0, 0.2, 0.2>, 2.6, 2.6, rgb 0.62 * <1, 0.94, 0.84>, 6, U_2, U_3)

#declare Fill = finish { ambient 0.035 * <0.8, 0.9, 1.1> diffuse 0.8 }
#declare Skin = finish { Fill specular 0.3 roughness 0.04 }

plane { y, 0 Surface(1, texture { T_Wood7 finish { Fill } scale 1.6 rotate <2, 72, 0> }) }
plane { -z, -4.5 rotate -12 * y Surface(2, texture { pigment { rgb <0.42, 0.40, 0.34> } finish { Fill } }) }

// The bowl.
difference {
    sphere { 0, 1 scale <1.35, 0.80, 1.35> translate 0.86 * y }
    sphere { 0, 1 scale <1.27, 0.74, 1.27> translate 0.88 * y }
    box { <-2, 0.90, -2>, <2, 2, 2> }
    Surface(3, texture { pigment { rgb <0.22, 0.36, 0.52> } finish { Skin } })
    translate <-0.25, 0, 0.6>
}
torus {
    0.5, 0.07 translate <-0.25, 0.07, 0.6>
    Surface(3, texture { pigment { rgb <0.22, 0.36, 0.52> } finish { Skin } })
}

#macro Fruit(Where, R, Number, Colour)
    union {
        sphere { 0, R scale <1, 0.93, 1> }
        cylinder { 0.8 * R * y, 1.12 * R * y, 0.03 }
        rotate <20 * Where.z, 0, 25 * Where.x>
        translate Where
        Surface(Number, texture { pigment { Colour } finish { Skin } })
    }
#end
Fruit(<-0.75, 0.98, 0.30>, 0.44, 4, rgb <0.72, 0.10, 0.07>)
Fruit(<0.20, 0.95, 0.15>, 0.41, 5, rgb <0.85, 0.52, 0.08>)
Fruit(<-0.20, 1.02, 1.05>, 0.46, 6, rgb <0.45, 0.55, 0.12>)
Fruit(<-0.28, 1.45, 0.52>, 0.40, 7, rgb <0.78, 0.22, 0.10>)
Fruit(<1.05, 0.36, -1.55>, 0.38, 5, rgb <0.85, 0.52, 0.08>)
Fruit(<-0.55, 0.33, -2.35>, 0.35, 4, rgb <0.72, 0.10, 0.07>)

// The candlestick.
lathe {
    bezier_spline 16
    <0.00, 0.00> <0.25, 0.00> <0.50, 0.00> <0.50, 0.06>
    <0.50, 0.06> <0.50, 0.20> <0.12, 0.16> <0.11, 0.50>
    <0.11, 0.50> <0.10, 0.90> <0.22, 1.00> <0.11, 1.20>
    <0.11, 1.20> <0.08, 1.40> <0.30, 1.42> <0.30, 1.52>
    translate <1.35, 0, 2.0>
    Surface(8, texture { pigment { rgb <0.6, 0.42, 0.16> } finish { Fill specular 0.5 roughness 0.02 } })
}
cylinder {
    <1.35, 1.44, 2.0>, <1.35, 2.65, 2.0>, 0.15
    Surface(9, texture { pigment { rgb <0.88, 0.84, 0.74> } finish { Fill } })
}
