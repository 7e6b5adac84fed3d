# DATE: 2026-11-21 UNITS: si CONTRIBUTOR: FSI package CITATION: Antoci, Gallati and Sibilla, Computers and Structures 85 (2007) 879
# One material per line: name, fluid, solid or wall, then keyword and value (doc/src/materials.rst).
#   fluid: rho [kg/m^3], viscosity [Pa s] (default 0)
#   solid: rho [kg/m^3], young [Pa], poisson [-], yield [Pa], hardening [Pa]
# The speed of sound of a fluid is a numerical choice and belongs to the input script.

# ---- common materials: textbook values at room temperature ----

# water at 20 C
water            fluid rho 1000.0 viscosity 1.0e-3
# water without viscosity, as the benchmarks treat it
water_inviscid   fluid rho 1000.0
# sunflower oil at room temperature, rounded: the oil of Botia-Vera, Souto-Iglesias, Bulian and Lobovsky's sloshing experiments
# (SPHERIC benchmark 10, 2010), 5e-5 m^2/s
oil              fluid rho 917.0 viscosity 0.0459
# glycerol at 20 C: CRC Handbook of Chemistry and Physics (viscosity 1.41 Pa s)
glycerol         fluid rho 1261.0 viscosity 1.41
# rubbers as linear elastic bodies at small strain, nearly incompressible: representative values, no particular rubber (after Ashby, Materials Selection in
# Mechanical Design: natural rubber 1.5-2.5 MPa, 0.92-0.93 kg/l; silicone 5-20 MPa, 1.3-1.8 kg/l); poisson 0.49 stands for 0.4999
rubber_natural   solid rho 930.0 young 2.0e6 poisson 0.49
rubber_silicone  solid rho 1300.0 young 5.0e6 poisson 0.49
# aluminum alloy 6061-T6, typical values of data sheets (Aluminum Association); linear hardening of 0.5 GPa joins
# yield (276 MPa) to strength (310 MPa) at some 7 % strain
aluminum         solid rho 2700.0 young 68.9e9 poisson 0.33 yield 276.0e6 hardening 0.5e9
# structural steel, EN 1993-1-1: S235
steel            solid rho 7850.0 young 210.0e9 poisson 0.3 yield 235.0e6

# ---- benchmarks ----
# Taylor-Green vortices with U = L = 1 at Re = 100
vortex_Re100     fluid rho 1000.0 viscosity 10.0
# Lid-driven cavity with U = L = 1 at Re = 100 (the same), 400 and 1000: Ghia, Ghia and Shin, J. Comput. Phys. 48 (1982) 387
vortex_Re400     fluid rho 1000.0 viscosity 2.5
vortex_Re1000    fluid rho 1000.0 viscosity 1.0
# Channel of Schaefer and Turek, and of Turek and Hron: nu = 1e-3 m^2/s
channel_water    fluid rho 1000.0 viscosity 1.0

# Rubber gate of Antoci, Gallati and Sibilla, Computers and Structures 85 (2007) 879: 12 MPa as it
# is quoted for the experiment, 10 MPa as in later computations of it
gate_12MPa       solid rho 1100.0 young 12.0e6 poisson 0.4
gate_10MPa       solid rho 1100.0 young 10.0e6 poisson 0.4

# Oscillating plate of Gray, Monaghan and Swift, Comput. Methods Appl. Mech. Engrg. 190 (2001) 6641:
# bulk modulus 3.25 MPa and shear modulus 0.715 MPa
plate            solid rho 1000.0 young 1.9984472e6 poisson 0.39751553

# fluid of nu = 0.002 m^2/s, for the decay of a standing wave a metre or two long
wave_viscous     fluid rho 1000.0 viscosity 2.0
# Elastic beam of Turek and Hron, in Fluid-Structure Interaction (Springer LNCSE 53, 2006) 371: structural tests CSM1, CSM3
turek_csm        solid rho 1000.0 young 1.4e6 poisson 0.4
# The same in a stream: FSI1 has the beam of the structural tests, FSI2 and FSI3 have these
turek_fsi2       solid rho 10000.0 young 1.4e6 poisson 0.4
turek_fsi3       solid rho 1000.0 young 5.6e6 poisson 0.4

# Plate under a water column: Fourey, Oger, Le Touze and Alessandrini, IOP Conf. Ser.: Mater. Sci. Eng. 10 (2010) 012041
hydrostatic_plate  solid rho 2700.0 young 67.5e9 poisson 0.34

# Plate as thin as a shell (scene submerged_plate): a soft plastic
shell            solid rho 1100.0 young 100.0e6 poisson 0.3

# Columns that bend and twist: Lee, Gil and Bonet, Computers and Structures 118 (2013) 13
column           solid rho 1100.0 young 17.0e6 poisson 0.45

# Block of half the density of water (scene floating_blocks)
float_500        solid rho 500.0 young 1.0e6 poisson 0.3

# Rubber rings that collide: Gray, Monaghan and Swift, Comput. Methods Appl. Mech. Engrg. 190 (2001) 6641; only ratios matter
ring             solid rho 1200.0 young 10.0e6 poisson 0.3975

# Walls made of particles: fixed or prescribed ones have no mass that matters; a floating body has its own density
wall             wall rho 1000.0

# Rolling tank with an elastic baffle: Botia-Vera, Souto-Iglesias, Bulian and Lobovsky, 5th SPHERIC workshop (2010); Idelsohn, Marti,
# Souto-Iglesias and Onate, Comput. Mech. 43 (2008) 125
sunflower_oil    fluid rho 917.0 viscosity 0.04585
baffle_6MPa      solid rho 1100.0 young 6.0e6 poisson 0.49

# Elastic obstacle in a dam break: Walhorn, Koelke, Huebner and Dinkler, Computers and Structures 83 (2005) 2100
obstacle_1MPa    solid rho 2500.0 young 1.0e6 poisson 0.0

# Plate behind a lifting gate: Liao, Hu and Sueyoshi, Appl. Ocean Res. 50 (2015) 94
rubber_3.5MPa    solid rho 1161.54 young 3.5e6 poisson 0.49

# Copper of the Taylor bar: Zhu and Cescotto, Int. J. Numer. Methods Eng. 38 (1995) 987; linear hardening
copper           solid rho 8930.0 young 117.0e9 poisson 0.35 yield 400.0e6 hardening 100.0e6

# Foam of Luhar and Nepf, Limnol. Oceanogr. 56 (2011) 2003, as Tian, Dai, Luo, Doyle and Rousseau, J. Comput. Phys. 258 (2014) 451, have it:
# E/(rho U^2) = 19054.9 with U = 0.16 m/s, which makes their Re 1600 with a width of 1 cm
foam             solid rho 678.0 young 4.87805e5 poisson 0.4

# Ring in a fluid-filled annulus: solids4foam, test ringAddedMass; fluids of 14, 140 and 1400 kg/m^3 make an added mass of about 0.1, 1 and 10 times the ring's
annulus_ring     solid rho 1000.0 young 1.0e6 poisson 0.3
annulus_140      fluid rho 140.0

# Folded strip (scene folded_strip): a soft rubber
strip            solid rho 1000.0 young 1.0e6 poisson 0.3

# Valve (scene valve): two leaflets of a soft gel in water ten times as viscous as at 20 C
valve_water      fluid rho 1000.0 viscosity 0.01
leaflet          solid rho 1100.0 young 0.6e6 poisson 0.49
