// Control: an object that allocates by itself.
int* gate_control_new(int value) { return new int(value); }
