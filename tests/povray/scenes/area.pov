// A chessboard's corner under one large window: light (u, v).
#include "stack.inc"
#include "woods.inc"

Lens_camera(<-1.1, 4.2, -8.6>, <0.1, 0.95, 0.3>, 34, 0, 0.5, 0.5)
Panel_point(<-5.6, 6.4, 0.4>, <0.3, 0, 0.2>, 4.4, 2.6, rgb 0.62 * <1, 0.93, 0.82>, 7, U_0, U_1)

#declare Fill = finish { ambient 0.035 * <0.75, 0.85, 1.1> diffuse 0.85 }
#declare Ivory = texture { pigment { rgb <0.9, 0.84, 0.7> } finish { Fill specular 0.35 roughness 0.03 } }
#declare Ebony = texture { pigment { rgb <0.1, 0.055, 0.035> } finish { Fill specular 0.45 roughness 0.02 } }
#declare Light_square = texture { pigment { rgb <0.86, 0.74, 0.54> } finish { Fill } }
#declare Dark_square = texture { pigment { rgb <0.33, 0.17, 0.09> } finish { Fill } }

#declare Pawn = union {
    lathe {
        bezier_spline 16
        <0.00, 0.00> <0.20, 0.00> <0.42, 0.00> <0.42, 0.05>
        <0.42, 0.05> <0.42, 0.18> <0.34, 0.16> <0.34, 0.24>
        <0.34, 0.24> <0.34, 0.36> <0.14, 0.44> <0.14, 0.86>
        <0.14, 0.86> <0.14, 0.92> <0.06, 0.92> <0.00, 0.92>
    }
    sphere { <0, 0, 0>, 1 scale <0.26, 0.06, 0.26> translate 0.86 * y }
    sphere { <0, 1.10, 0>, 0.25 }
}
#declare Rook = union {
    lathe {
        bezier_spline 16
        <0.00, 0.00> <0.20, 0.00> <0.45, 0.00> <0.45, 0.06>
        <0.45, 0.06> <0.45, 0.22> <0.36, 0.20> <0.36, 0.30>
        <0.36, 0.30> <0.34, 0.44> <0.24, 0.50> <0.24, 1.10>
        <0.24, 1.10> <0.24, 1.16> <0.06, 1.16> <0.00, 1.16>
    }
    difference {
        cylinder { 1.05 * y, 1.50 * y, 0.36 }
        cylinder { 1.25 * y, 1.60 * y, 0.25 }
        box { <-0.5, 1.34, -0.07>, <0.5, 1.6, 0.07> }
        box { <-0.5, 1.34, -0.07>, <0.5, 1.6, 0.07> rotate 60 * y }
        box { <-0.5, 1.34, -0.07>, <0.5, 1.6, 0.07> rotate 120 * y }
    }
}
#declare Bishop = union {
    lathe {
        bezier_spline 16
        <0.00, 0.00> <0.20, 0.00> <0.45, 0.00> <0.45, 0.06>
        <0.45, 0.06> <0.45, 0.22> <0.34, 0.20> <0.34, 0.30>
        <0.34, 0.30> <0.34, 0.46> <0.13, 0.56> <0.15, 1.16>
        <0.15, 1.16> <0.15, 1.20> <0.06, 1.20> <0.00, 1.20>
    }
    sphere { 0, 1 scale <0.27, 0.06, 0.27> translate 1.16 * y }
    difference {
        sphere { 0, 1 scale <0.25, 0.36, 0.25> translate 1.48 * y }
        box { <0.0, -0.03, -1>, <1, 0.03, 1> rotate 50 * z translate 1.50 * y }
    }
    sphere { <0, 1.87, 0>, 0.08 }
}

box { <-4, -0.3, -4>, <4, 0, 4> Surface(1, Dark_square) }
#for (I, -4, 3)
    #for (J, -4, 3)
        #if (mod(I + J + 8, 2) = 1)
            box { <I, -0.1, J>, <I + 1, 0.001, J + 1> Surface(2, Light_square) }
        #end
    #end
#end
plane { y, -0.3 Surface(3, texture { T_Wood10 finish { Fill } scale 2.2 rotate 8 * y }) }
plane { -z, -7.5 Surface(4, texture { pigment { rgb <0.36, 0.42, 0.46> } finish { Fill } }) }

object { Rook translate <-1.5, 0, 1.5> Surface(5, Ivory) }
object { Bishop rotate -30 * y translate <0.5, 0, 2.5> Surface(5, Ivory) }
object { Pawn translate <-0.5, 0, -0.5> Surface(5, Ivory) }
object { Pawn translate <-2.5, 0, -0.5> Surface(5, Ivory) }
object { Pawn translate <1.5, 0, 0.5> Surface(6, Ebony) }
object { Pawn translate <2.5, 0, 2.5> Surface(6, Ebony) }
object { Rook rotate 20 * y translate <2.5, 0, -0.5> Surface(6, Ebony) }
object { Pawn rotate <0, 0, -90> translate <0.2, 0.25, -1.6> Surface(6, Ebony) }
