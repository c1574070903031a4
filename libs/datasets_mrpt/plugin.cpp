#include "datasets/rawlog.hpp"
#include "datasets_mrpt/rawlog_reader.hpp"
#include "datasets_mrpt/rawlog_writer.hpp"

extern "C" {
extern const noctule::datasets::RawlogPlugin noctule_rawlog_plugin;
const noctule::datasets::RawlogPlugin noctule_rawlog_plugin{&noctule::datasets::read_rawlog,
                                                            &noctule::datasets::create_rawlog};
}
