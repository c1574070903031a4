noctule_bench(state_filter ROOMS particle models)
