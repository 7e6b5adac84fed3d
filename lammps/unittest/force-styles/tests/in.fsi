variable  newton_pair     index  on
variable  newton_bond     index  on
variable  units           index  si
variable  input_dir       index  .
variable  data_file       index ${input_dir}/data.fsi
variable  pair_style      index 'zero 0.03'

units            ${units}
boundary         f f f
atom_style       fsi
atom_modify      map array
neighbor         0.003 bin
neigh_modify     delay 0 every 1 check no
timestep         0.0001
newton           ${newton_pair} ${newton_bond}

pair_style       ${pair_style}
read_data        ${data_file}
