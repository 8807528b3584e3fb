# offnominal_torque_space(<robot file> <bounds> <file>): the robot with its monitor in torque space, and of
# every joint one of the bounds, N m: "1.0, 2.0". [uncertainty_bound] has to be its last table.
function(offnominal_torque_space robot bounds file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${robot}")
  file(READ "${robot}" text)
  string(FIND "${text}" "[uncertainty_bound]" end)
  string(SUBSTRING "${text}" 0 ${end} text)
  string(REPLACE "[estimator]" "[estimator]\nspace = \"torque\"" text "${text}")
  string(APPEND text "[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [${bounds}]\n"
                     "source = \"chosen: something to cross\"\n")
  file(CONFIGURE OUTPUT "${file}" CONTENT "${text}" @ONLY)
endfunction()

# offnominal_isolation(<robot file> <file>): the robot in torque space, whose controller says which fault it is.
function(offnominal_isolation robot file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${robot}")
  file(READ "${robot}" text)
  string(REPLACE "[estimator]" "[estimator]\nisolation = true" text "${text}")
  file(CONFIGURE OUTPUT "${file}" CONTENT "${text}" @ONLY)
endfunction()

# offnominal_two_filters(<robot file> <bounds> <file>): the robot in torque space with a second filter beside it,
# whose bounds are those, one per joint.
function(offnominal_two_filters robot bounds file)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${robot}")
  file(READ "${robot}" text)
  string(REPLACE "[estimator]" "[estimator]\nfast_alpha_per_s = 30.0" text "${text}")
  string(REPLACE "kind = \"per_joint\"" "kind = \"per_joint\"\nfast = {value = [${bounds}]}" text "${text}")
  file(CONFIGURE OUTPUT "${file}" CONTENT "${text}" @ONLY)
endfunction()

# offnominal_counted_arm(<joints> <hidden units> <file>): bench/discovery's arm with the first joints
# only, and the estimator and bound that it lacks.
function(offnominal_counted_arm joints hidden file)
  set(arm "${PROJECT_SOURCE_DIR}/bench/discovery/seven_joint_arm.toml")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${arm}")
  file(READ "${arm}" text)
  # CMake's lists and regular expressions do not like brackets in pairs.
  string(REPLACE "[[" "<<" text "${text}")
  string(REPLACE "]]" ">>" text "${text}")
  math(EXPR next "${joints} + 1")
  if(next LESS_EQUAL 7)
    foreach(joint RANGE ${next} 7)
      string(REGEX REPLACE "<<joint>>\nname = \"joint${joint}\"[^<]*" "" text "${text}")
      string(REGEX REPLACE "<<effect>>\nkind = \"[a-z_]+\"\njoint = ${joint}\n[^<]*" "" text "${text}")
    endforeach()
  endif()
  string(REPLACE "<<" "[[" text "${text}")
  string(REPLACE ">>" "]]" text "${text}")
  string(APPEND text "
[estimator]
period_s = 0.001
alpha_per_s = 10.0
hidden_units = ${hidden}
learning_rate = 2.5
weight_radius = 10.0
initial_weight_range = 0.1
seed = 1
dead_zone = \"continuous\"
torque_signal = \"held\"

[uncertainty_bound]
kind = \"constant\"
value = 1.0
source = \"chosen: something to cross\"
")
  file(CONFIGURE OUTPUT "${file}" CONTENT "${text}" @ONLY)
endfunction()
