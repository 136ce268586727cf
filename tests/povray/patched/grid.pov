// A light of 4 x 4 over a few objects, as a whole or point by point: what is made of the points must be the whole.
// With Area=1 an area light, else frame k has a point light at the centre of the light's cell k of 16 x 16.
#version 3.7;
global_settings { assumed_gamma 1.0 }

#declare Light = <-6, 12, -8>;
light_source {
   #ifdef (Area)
      Light color rgb <0.8, 0.75, 0.7>
      area_light 4*x, 4*z, 16, 16
   #else
      #declare I = mod(frame_number, 16);
      #declare J = floor(frame_number/16);
      Light + 4*x*((I + 0.5)/16 - 0.5) + 4*z*((J + 0.5)/16 - 0.5) color rgb <0.8, 0.75, 0.7>
   #end
}

camera { location <0, 7, -14> look_at <0, 1, 0> angle 45 right x*image_width/image_height }

plane { y, 0 pigment { checker rgb 0.8 rgb <0.3, 0.5, 0.3> scale 2 } finish { ambient 0.05 diffuse 0.8 } }
sphere {
    <0, 2, 0>, 2
    pigment { rgb <0.9, 0.3, 0.2> }
    finish { ambient 0.05 diffuse 0.7 phong 0.4 phong_size 40 reflection 0.2 }
}
box { <2.5, 0, -3>, <4.5, 3, -1> rotate 15*y pigment { rgb <0.3, 0.4, 0.8> } finish { ambient 0.05 diffuse 0.7 } }
cylinder { <-4, 0, -1>, <-4, 2.5, -1>, 0.8 pigment { rgbf <0.9, 0.9, 0.5, 0.5> } finish { ambient 0.05 diffuse 0.6 } }
