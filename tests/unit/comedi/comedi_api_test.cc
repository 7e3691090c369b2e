// What is declared of libcomedi, beside its own header and its own library.
#include "devices/comedi/comedi_api.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#ifdef HANDRAIL_COMEDI_HEADERS
#include <comedilib.h>
#endif

#include <cstddef>

namespace handrail {
namespace {

using ::testing::HasSubstr;

#ifdef HANDRAIL_COMEDI_HEADERS
template <typename A, typename B>
constexpr bool alike = sizeof(A) == sizeof(B) && alignof(A) == alignof(B);

static_assert(alike<ComediRange, comedi_range>);
static_assert(offsetof(ComediRange, max) == offsetof(comedi_range, max));
static_assert(offsetof(ComediRange, unit) == offsetof(comedi_range, unit));
static_assert(alike<ComediInsn, comedi_insn>);
static_assert(offsetof(ComediInsn, insn) == offsetof(comedi_insn, insn));
static_assert(offsetof(ComediInsn, n) == offsetof(comedi_insn, n));
static_assert(offsetof(ComediInsn, data) == offsetof(comedi_insn, data));
static_assert(offsetof(ComediInsn, subdev) == offsetof(comedi_insn, subdev));
static_assert(offsetof(ComediInsn, chanspec) == offsetof(comedi_insn, chanspec));
static_assert(alike<ComediInsnList, comedi_insnlist>);
static_assert(offsetof(ComediInsnList, insns) == offsetof(comedi_insnlist, insns));
static_assert(alike<ComediCommand, comedi_cmd>);
static_assert(offsetof(ComediCommand, flags) == offsetof(comedi_cmd, flags));
static_assert(offsetof(ComediCommand, start_src) == offsetof(comedi_cmd, start_src));
static_assert(offsetof(ComediCommand, scan_begin_src) == offsetof(comedi_cmd, scan_begin_src));
static_assert(offsetof(ComediCommand, scan_begin_arg) == offsetof(comedi_cmd, scan_begin_arg));
static_assert(offsetof(ComediCommand, convert_src) == offsetof(comedi_cmd, convert_src));
static_assert(offsetof(ComediCommand, convert_arg) == offsetof(comedi_cmd, convert_arg));
static_assert(offsetof(ComediCommand, scan_end_src) == offsetof(comedi_cmd, scan_end_src));
static_assert(offsetof(ComediCommand, stop_src) == offsetof(comedi_cmd, stop_src));
static_assert(offsetof(ComediCommand, chanlist) == offsetof(comedi_cmd, chanlist));
static_assert(offsetof(ComediCommand, chanlist_len) == offsetof(comedi_cmd, chanlist_len));
static_assert(offsetof(ComediCommand, data_len) == offsetof(comedi_cmd, data_len));
static_assert(kComediInsnRead == INSN_READ && kComediInsnWrite == INSN_WRITE);
static_assert(kComediAnalogIn == COMEDI_SUBD_AI && kComediAnalogOut == COMEDI_SUBD_AO);
static_assert(kComediDigitalIn == COMEDI_SUBD_DI && kComediDigitalBoth == COMEDI_SUBD_DIO);
static_assert(kComediCounter == COMEDI_SUBD_COUNTER);
static_assert(kComediStreams == SDF_CMD_READ && kComediLongSamples == SDF_LSAMPL);
static_assert(kComediVolt == UNIT_volt && kComediWakeEachScan == CMDF_WAKE_EOS);
static_assert(kComediNever == TRIG_NONE && kComediNow == TRIG_NOW);
static_assert(kComediTimer == TRIG_TIMER && kComediCount == TRIG_COUNT);
static_assert(kComediNiX4 == NI_GPCT_COUNTING_MODE_QUADRATURE_X4_BITS);
static_assert(kComediNiUpDown == NI_GPCT_COUNTING_DIRECTION_HW_UP_DOWN_BITS);
static_assert(kComediNiNoGate == NI_GPCT_DISABLED_GATE_SELECT);
static_assert(comedi_channel(7, 3, AREF_DIFF) == CR_PACK(7, 3, AREF_DIFF));
static_assert(comedi_channel(0xffff, 0xff, AREF_OTHER) == CR_PACK(0xffff, 0xff, AREF_OTHER));

// The same arguments and result as the header's function, but for what a pointer points to.
template <typename T>
struct Plain {
  using type = T;
};
template <typename T>
struct Plain<T*> {
  using type = void*;
};
template <>
struct Plain<const char*> {
  using type = const char*;
};
template <typename Ours, typename Theirs>
constexpr bool same_call = false;
template <typename R1, typename... A1, typename R2, typename... A2>
constexpr bool same_call<R1 (*)(A1...), R2 (*)(A2...)> =
    std::is_same_v<void(typename Plain<R1>::type, typename Plain<A1>::type...),
                   void(typename Plain<R2>::type, typename Plain<A2>::type...)>;

static_assert(same_call<decltype(ComediApi::open), decltype(&comedi_open)>);
static_assert(same_call<decltype(ComediApi::close), decltype(&comedi_close)>);
static_assert(same_call<decltype(ComediApi::log_level), decltype(&comedi_loglevel)>);
static_assert(same_call<decltype(ComediApi::file), decltype(&comedi_fileno)>);
static_assert(same_call<decltype(ComediApi::driver_name), decltype(&comedi_get_driver_name)>);
static_assert(same_call<decltype(ComediApi::board_name), decltype(&comedi_get_board_name)>);
static_assert(same_call<decltype(ComediApi::subdevices), decltype(&comedi_get_n_subdevices)>);
static_assert(same_call<decltype(ComediApi::type), decltype(&comedi_get_subdevice_type)>);
static_assert(same_call<decltype(ComediApi::flags), decltype(&comedi_get_subdevice_flags)>);
static_assert(same_call<decltype(ComediApi::channels), decltype(&comedi_get_n_channels)>);
static_assert(same_call<decltype(ComediApi::max_data), decltype(&comedi_get_maxdata)>);
static_assert(same_call<decltype(ComediApi::ranges), decltype(&comedi_get_n_ranges)>);
static_assert(same_call<decltype(ComediApi::range), decltype(&comedi_get_range)>);
static_assert(same_call<decltype(ComediApi::insn_list), decltype(&comedi_do_insnlist)>);
static_assert(same_call<decltype(ComediApi::command_test), decltype(&comedi_command_test)>);
static_assert(same_call<decltype(ComediApi::command), decltype(&comedi_command)>);
static_assert(same_call<decltype(ComediApi::cancel), decltype(&comedi_cancel)>);
static_assert(same_call<decltype(ComediApi::lock), decltype(&comedi_lock)>);
static_assert(same_call<decltype(ComediApi::reset), decltype(&comedi_reset)>);
static_assert(same_call<decltype(ComediApi::gate), decltype(&comedi_set_gate_source)>);
static_assert(same_call<decltype(ComediApi::counter_mode), decltype(&comedi_set_counter_mode)>);
static_assert(same_call<decltype(ComediApi::arm), decltype(&comedi_arm)>);

#endif

// The rest of it is checked above, while this is compiled.
TEST(ComediApi, IsThatOfTheInstalledHeader) {
#ifdef HANDRAIL_COMEDI_HEADERS
  EXPECT_EQ(comedi_channel(7, 3, 2), static_cast<unsigned int>(CR_PACK(7, 3, AREF_DIFF)));
#else
  GTEST_SKIP() << "libcomedi-dev is not installed";
#endif
}

TEST(ComediApi, DebiansLibraryHasEveryFunction) {
  const auto api = load_comedi(kComediLibrary);
  if (!api && api.message().find("cannot be loaded") != std::string::npos) {
    GTEST_SKIP() << "libcomedi0 is not installed";
  }
  ASSERT_TRUE(api) << api.message();
  EXPECT_EQ(api->open("/dev/null"), nullptr);
}

TEST(ComediApi, ALibraryThatIsNoneIsNamed) {
  EXPECT_THAT(load_comedi("/nowhere/libcomedi.so.0").message(),
              HasSubstr("comedi: /nowhere/libcomedi.so.0: cannot be loaded"));
  EXPECT_THAT(load_comedi("/nowhere/libcomedi.so.0").message(),
              HasSubstr("; sudo apt-get install libcomedi0"));
  EXPECT_THAT(load_comedi("libm.so.6").message(),
              HasSubstr("comedi: libm.so.6: has no comedi_open, expected libcomedi 0.11; sudo"));
}

}  // namespace
}  // namespace handrail
