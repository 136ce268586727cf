// A windmill that turns and a ball that bounces while the shutter is open, under a window: time, light (u, v).
#include "stack.inc"

Lens_camera(<0.3, 2.7, -8.4>, <0.1, 1.75, 0>, 36, 0, 0.5, 0.5)
Panel_point(<-4.6, 6.2, -3.2>, <0, 1, 0.4>, 2.4, 2.4, rgb 0.70 * <1, 0.94, 0.84>, 7, U_1, U_2)

#declare Time = U_0;
#declare Fill = finish { ambient 0.04 * <0.8, 0.9, 1.1> diffuse 0.85 }
#macro Paint(R, G, B) texture { pigment { rgb <R, G, B> } finish { Fill specular 0.2 roughness 0.05 } } #end

plane {
    y, 0
    Surface(1, texture { pigment { checker rgb <0.62, 0.58, 0.5>, rgb <0.42, 0.43, 0.42> scale 0.9 } finish { Fill } })
}
plane { -z, -5 Surface(2, texture { pigment { rgb <0.45, 0.52, 0.56> } finish { Fill } }) }

// The mill: a tower, and four sails that make a twelfth of a turn.
cone { <-1.1, 0, 1.4>, 0.85, <-1.1, 2.5, 1.4>, 0.52 Surface(3, Paint(0.8, 0.74, 0.62)) }
cone { <-1.1, 2.5, 1.4>, 0.66, <-1.1, 3.25, 1.4>, 0.0 Surface(4, Paint(0.55, 0.16, 0.1)) }
box { <-1.32, 0, 0.4>, <-0.88, 0.75, 1.0> Surface(5, Paint(0.3, 0.2, 0.12)) }
cylinder { <-1.1, 2.3, 0.3>, <-1.1, 2.3, 1.2>, 0.09 Surface(5, Paint(0.3, 0.2, 0.12)) }
union {
    #for (I, 0, 3)
        union {
            box { <-0.045, 0, -0.03>, <0.045, 1.75, 0.03> }
            box { <0.0, 0.45, -0.015>, <0.40, 1.70, 0.015> rotate 8 * y }
            rotate 90 * I * z
        }
    #end
    rotate (20 + 30 * Time) * z
    translate <-1.1, 2.3, 0.28>
    Surface(6, Paint(0.75, 0.66, 0.45))
}

// The ball's arc.
#declare Arc = 0.9 + 1.5 * Time;
sphere { <Arc, 0.42 + 1.5 * (1 - pow(1.7 * Time - 0.7, 2)), -0.9>, 0.42 Surface(7, Paint(0.78, 0.2, 0.08)) }
sphere { <2.55, 0.5, 1.3>, 0.5 Surface(8, Paint(0.2, 0.4, 0.62)) }
box { <-0.55, 0, -0.55>, <0.55, 0.8, 0.55> rotate 25 * y translate <0.75, 0, 1.1> Surface(9, Paint(0.3, 0.5, 0.3)) }
