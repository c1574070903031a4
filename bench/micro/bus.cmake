find_package(LCM REQUIRED)
noctule_bench(bus ROOMS bus convert LINK LCM::lcm)
