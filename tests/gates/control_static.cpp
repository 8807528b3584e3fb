// Control: a local static whose construction has to be guarded.
int gate_control_source();

int gate_control_static() {
  static const int kValue = gate_control_source();
  return kValue;
}
