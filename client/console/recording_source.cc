#include <spdlog/spdlog.h>

#include <utility>

#include "client/console/console_source.h"
#include "client/console/play/play_link.h"
#include "server/base/clock.h"
#include "server/base/version.h"

namespace handrail {
namespace {

class RecordingSource final : public ConsoleSource {
 public:
  RecordingSource(std::unique_ptr<RecordingReader> recording, const Post& post, PageSink& pages,
                  ViewerDesk& viewers)
      : news_(recording_news(*recording)),
        range_{recording->begins(), recording->ends()},
        viewers_(viewers),
        player_(std::move(recording), post,
                {[this](const Result<pb::Reply>& reply, Nanos asked, const PlayState& state) {
                   see(reply, asked, state);
                 },
                 [this](const std::string& name, const Result<ReadScene>& scene) {
                   if (app_ != nullptr) app_->show(name, scene);
                 }}),
        desk_(pages, PlayedRecording{news_, &player_},
              PageDeskOptions{false, program_version(), "", news_.file()}) {
    viewers.show_recording(range_, player_);
  }

  PageDesk& desk() override { return desk_; }
  void show_to(ConsoleApp& app) override { app_ = &app; }
  const pb::RecordingNews* recording() const override { return &news_; }

 private:
  void see(const Result<pb::Reply>& reply, Nanos asked, const PlayState& state) {
    const std::string problem = reply ? "" : reply.message();
    if (problem != std::exchange(said_, problem) && !problem.empty()) spdlog::warn("{}", problem);
    if (!viewers_.played(state)) return;
    desk_.played(state);
    desk_.status(reply, asked, monotonic_now());
    viewers_.status(reply, calendar_now());
  }

  const pb::RecordingNews news_;
  const ViewerRange range_;
  ViewerDesk& viewers_;
  ConsoleApp* app_ = nullptr;
  std::string said_;
  // What its thread has in hand comes while the gateway runs: the desk is there by then.
  PlayLink player_;
  PageDesk desk_;
};

}  // namespace

Result<std::unique_ptr<ConsoleSource>> recording_source(const ConsoleArgs& args,
                                                        ConsoleSource::Post post, PageSink& pages,
                                                        ViewerDesk& viewers) {
  auto recording = RecordingReader::open(args.recording);
  if (!recording) return recording.status();
  if (!(*recording)->damage().empty()) {
    spdlog::warn("{}: {}; it is shown up to there", args.recording, (*recording)->damage());
  }
  std::unique_ptr<ConsoleSource> out =
      std::make_unique<RecordingSource>(std::move(*recording), post, pages, viewers);
  return Result<std::unique_ptr<ConsoleSource>>(std::move(out));
}

}  // namespace handrail
