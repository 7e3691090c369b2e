#include "devices/comedi/comedi_api.h"

#include "devices/input/loaded_library.h"

namespace handrail {

Result<ComediApi> load_comedi(const std::string& library) {
  constexpr char kInstall[] = "sudo apt-get install libcomedi0";
  auto loaded = LoadedLibrary::load(library);
  if (!loaded) return Status::error("comedi: " + loaded.message() + "; " + kInstall);
  ComediApi api;
  const auto take = [&](const char* name, auto& out) { loaded->take(name, out); };
  take("comedi_open", api.open);
  take("comedi_close", api.close);
  take("comedi_loglevel", api.log_level);
  take("comedi_fileno", api.file);
  take("comedi_get_driver_name", api.driver_name);
  take("comedi_get_board_name", api.board_name);
  take("comedi_get_n_subdevices", api.subdevices);
  take("comedi_get_subdevice_type", api.type);
  take("comedi_get_subdevice_flags", api.flags);
  take("comedi_get_n_channels", api.channels);
  take("comedi_get_maxdata", api.max_data);
  take("comedi_get_n_ranges", api.ranges);
  take("comedi_get_range", api.range);
  take("comedi_do_insnlist", api.insn_list);
  take("comedi_command_test", api.command_test);
  take("comedi_command", api.command);
  take("comedi_cancel", api.cancel);
  take("comedi_lock", api.lock);
  take("comedi_reset", api.reset);
  take("comedi_set_gate_source", api.gate);
  take("comedi_set_counter_mode", api.counter_mode);
  take("comedi_arm", api.arm);
  if (loaded->missing() != nullptr) {
    loaded->unload();
    return Status::error("comedi: " + shown(library, 200) + ": has no " + loaded->missing() +
                         ", expected libcomedi 0.11; " + kInstall);
  }
  (void)api.log_level(0);  // what fails is said by us
  return api;
}

}  // namespace handrail
