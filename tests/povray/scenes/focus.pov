// A row of marbles on a slab, from near to far, through a wide lens: lens (u, v).
#include "stack.inc"

Lens_camera(<-2.6, 2.1, -7.4>, <-0.15, 0.55, -0.6>, 34, 0.34, U_0, U_1)

#if (Sampled)
    light_source { <-7, 11, -6>, rgb 0.40 * <1, 0.95, 0.86> }
    light_source { <9, 6, -3>, rgb 0.16 * <0.6, 0.8, 1> }
#end

#declare Fill = finish { ambient 0.03 diffuse 0.8 }
#declare Gloss = finish {
    ambient 0.03 diffuse 0.75 specular 0.25 roughness 0.01 reflection { 0.02, 0.18 } conserve_energy
}

#macro Marble(X, Z, R, Number, Pigment)
    sphere { <X, R, Z>, R Surface(Number, texture { pigment { Pigment } finish { Gloss } }) }
#end
#macro Plain(R, G, B) pigment { rgb <R, G, B> } #end
#macro Swirl(A, B)
    pigment {
        gradient y sine_wave frequency 3 turbulence 0.5
        color_map { [0.25 rgb A] [0.5 rgb B] [0.9 rgb A] }
        rotate <25, 0, 40>
    }
#end

plane { y, -0.35 Surface(1, texture { pigment { rgb <0.16, 0.17, 0.2> } finish { Fill } }) }
box {
    <-4.6, -0.35, -4.0>, <4.6, 0, 7.4>
    Surface(2, texture {
        pigment {
            granite scale 0.9
            color_map { [0 rgb <0.2, 0.19, 0.18>] [0.4 rgb <0.5, 0.47, 0.44>] [1 rgb <0.72, 0.68, 0.62>] }
        }
        finish { Fill }
    })
}
plane {
    -z, -13
    Surface(3, texture {
        pigment {
            gradient y color_map { [0 rgb <0.35, 0.3, 0.26>] [1 rgb <0.1, 0.14, 0.2>] }
            scale 7 translate -0.5 * y
        }
        finish { Fill }
    })
}

Marble(-1.15, -3.6, 0.34, 4, Swirl(<0.85, 0.85, 0.8>, <0.1, 0.25, 0.6>))
Marble(0.00, -2.7, 0.42, 5, Plain(0.75, 0.12, 0.08))
Marble(-1.55, -1.5, 0.50, 6, Plain(0.1, 0.42, 0.2))
Marble(0.10, -0.6, 0.62, 7, Swirl(<0.85, 0.6, 0.12>, <0.6, 0.12, 0.05>))
Marble(1.90, -0.2, 0.45, 8, Plain(0.12, 0.22, 0.62))
Marble(-1.20, 1.3, 0.58, 9, Plain(0.85, 0.78, 0.62))
Marble(1.35, 2.3, 0.80, 10, Plain(0.65, 0.65, 0.68))
Marble(-0.35, 4.0, 0.66, 11, Plain(0.8, 0.35, 0.08))
Marble(2.60, 4.6, 0.62, 12, Swirl(<0.8, 0.82, 0.85>, <0.55, 0.08, 0.2>))
Marble(0.95, 6.3, 0.70, 13, Plain(0.2, 0.55, 0.6))
Marble(-1.9, 6.1, 0.5, 14, Plain(0.7, 0.7, 0.15))
