// A sculpture hall with eight coloured panels of equal area: light (u, v), and which panel.
#include "stack.inc"

Lens_camera(<0.4, 2.5, -9.3>, <-0.1, 1.7, 0>, 44, 0, 0.5, 0.5)

// One of Cells_2 equally likely panels was chosen, so that its light counts so many times.
#declare Panels = Cells_2;
#declare Chosen = int(U_2 * Panels);
#declare Colours = array[8] {
    <1, 0.75, 0.5>, <0.45, 0.65, 1>, <1, 0.5, 0.45>, <0.55, 0.95, 0.6>,
    <0.9, 0.85, 0.7>, <0.8, 0.5, 1>, <1, 0.9, 0.4>, <0.5, 0.85, 0.95>
}
#declare Angle = 2 * pi * (Chosen + 0.5) / Panels;
#declare Centre = <4.4 * cos(Angle), 5.1 - 0.7 * mod(Chosen, 3), 0.4 + 3.6 * sin(Angle)>;
Panel_point(Centre, <0, 1.2, 0.2>, 1.3, 1.3, rgb Panels * 0.075 * Colours[mod(Chosen, 8)], 3.2, U_0, U_1)

#declare Fill = finish { ambient 0.012 diffuse 0.85 }
#declare Stone = texture { pigment { rgb <0.8, 0.78, 0.73> } finish { Fill } }
#declare Plinth = texture { pigment { rgb <0.34, 0.33, 0.34> } finish { Fill } }
#declare Floor = texture { pigment { rgb <0.58, 0.52, 0.45> } finish { Fill } }
#declare Wall = texture { pigment { rgb <0.66, 0.65, 0.63> } finish { Fill } }
#declare Bronze = texture { pigment { rgb <0.45, 0.27, 0.12> } finish { Fill specular 0.6 roughness 0.05 } }

plane { y, 0 Surface(1, Floor) }
plane { -z, -6 Surface(2, Wall) }
plane { x, -6 Surface(2, Wall) }
plane { -x, -6 Surface(2, Wall) }

#macro Base(X, Z, W, H)
    box { <X - W, 0, Z - W>, <X + W, H, Z + W> Surface(3, Plinth) }
#end

// A ring on its edge, a column of turned cubes, a sphere in a cage, and a knot of tori.
Base(-2.6, 1.4, 0.65, 0.8)
torus { 0.8, 0.24 rotate <90, 35, 0> translate <-2.6, 1.84, 1.4> Surface(4, Bronze) }

Base(2.5, 1.8, 0.65, 0.6)
#for (I, 0, 4)
    box {
        -0.42 * (1 - 0.1 * I), 0.42 * (1 - 0.1 * I)
        rotate 17 * I * y translate <2.5, 1.02 + 0.62 * I * (1 - 0.04 * I), 1.8>
        Surface(5, Stone)
    }
#end

Base(0, -0.4, 0.75, 0.5)
sphere {
    <0, 1.62, -0.4>, 0.62
    Surface(6, texture { pigment { rgb <0.62, 0.16, 0.12> } finish { Fill specular 0.4 roughness 0.03 } })
}
union {
    #for (I, 0, 2)
        torus { 1.02, 0.07 rotate 90 * x rotate 60 * I * y }
    #end
    torus { 1.02, 0.07 }
    rotate <0, 15, 20>
    translate <0, 1.62, -0.4>
    Surface(5, Stone)
}

Base(-1.0, 4.0, 0.6, 1.2)
union {
    torus { 0.5, 0.16 rotate 90 * x translate <-0.25, 0, 0> }
    torus { 0.5, 0.16 translate <0.25, 0, 0> }
    rotate <0, 25, 15>
    translate <-1.0, 1.95, 4.0>
    Surface(5, Stone)
}
sphere { <-1.7, 0.38, -2.3>, 0.38 Surface(5, Stone) }
sphere { <1.55, 0.3, -2.6>, 0.3 Surface(4, Bronze) }
