// The real programs while many clients keep the operators' socket busy.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include "tests/loopback/whole_cell.h"
#include "tests/support/crowd.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

struct Crowding {
  int size;
  Nanos period;  // between two acts of each
};

class CrowdTest : public WholeCell, public ::testing::WithParamInterface<Crowding> {
 protected:
  // Another connection for each, as the command line does.
  pb::Reply ask_anew(const std::string& text) {
    client.close();
    return ask(text);
  }
};

TEST_P(CrowdTest, EveryStopAndEveryOrderOfTheHolderIsAnswered) {
  order("as: 'ada' engage: true");
  const Crowd crowd(socket(), GetParam().size, GetParam().period);
  const auto all = static_cast<std::uint64_t>(GetParam().size);
  const Nanos give_up = monotonic_now() + kPatience;
  while (crowd.counts().acts < all && monotonic_now() < give_up) {
    sleep_until(monotonic_now() + kMillisecond);
  }
  OperatorClient holder(socket(), "ada");  // stays connected
  const auto drive = [&holder](const std::string& text) {
    pb::Request request;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request)) << text;
    const auto reply = holder.call(request, kPatience);
    EXPECT_TRUE(reply && reply->done())
        << text << ": " << (reply ? reply->reason() : reply.message());
  };
  for (int round = 0; round < 8; ++round) {
    for (const char* text :
         {"clutch: true", "clutch: false", "hand { displacement_mm: [0, 2, 0] duration_s: 0.1 }"}) {
      drive(text);
      EXPECT_TRUE(ask_anew("as: 'ada' " + std::string(text)).done()) << text;
    }
    const pb::Reply stop = ask_anew("stop: true as: 'eve'");
    EXPECT_TRUE(stop.done());
    EXPECT_THAT(stop.reason(), HasSubstr("the slave has it"));
    drive("reset: true");
    drive("engage: true");
  }
  pb::Request show;
  show.set_status(true);
  const auto last = holder.call(show, kPatience);
  ASSERT_TRUE(last) << last.message();
  EXPECT_EQ(last->status().lease().holder(), "ada");
  const Crowd::Counts counts = crowd.counts();
  EXPECT_GE(counts.acts, all);
  EXPECT_GT(counts.answers, 0u) << "the others are served too";
  EXPECT_TRUE(master->running());
}

// The last one is larger than what the master has room for, and comes and goes as fast as one
// thread can.
INSTANTIATE_TEST_SUITE_P(Crowds, CrowdTest,
                         ::testing::Values(Crowding{16, 10 * kMillisecond},
                                           Crowding{1000, 200 * kMillisecond},
                                           Crowding{1500, 20 * kMillisecond}),
                         [](const auto& crowd) { return "Of" + std::to_string(crowd.param.size); });

// A limit that an administrator has set higher than the master needs stays.
TEST_F(WholeCell, AHigherLimitOfDescriptorsIsLeftAlone) {
  const auto limit_of = [](const Program& program) {
    rlimit limit{};
    EXPECT_EQ(::prlimit(program.pid(), RLIMIT_NOFILE, nullptr, &limit), 0);
    return limit.rlim_cur;
  };
  rlimit own{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &own), 0);
  if (own.rlim_max < 4096) GTEST_SKIP() << "no more than " << own.rlim_max << " are allowed here";
  EXPECT_GE(limit_of(*master), 2048u);
  const rlimit higher{4096, own.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &higher), 0);
  master->kill();
  start_master();
  EXPECT_EQ(limit_of(*master), 4096u);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &own), 0);
}

}  // namespace
}  // namespace handrail
