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
