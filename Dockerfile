# A container with LAMMPS and the FSI package, tried by a first scene:
#   docker build -t lammps-fsi .
#   docker run -it lammps-fsi build/lmp -in examples/elastic_gate/in.elastic_gate
FROM debian:bookworm
COPY . /lammps-fsi
WORKDIR /lammps-fsi
RUN tools/run droplet
ENV LAMMPS_POTENTIALS=/lammps-fsi/potentials
CMD ["bash"]
