// Loaded into clang-tidy: leaves out of the analysis what system headers declare, and what would be
// instantiated of them.
//
// Findings in system headers are never shown, yet every check walks through all of them, with all
// that was instantiated of Eigen and the standard library: more than half of the time. The analysis
// of Clang 21 leaves them out by itself; this does so for the one of Debian 12, by the same means
// as clangd does. Of what remains, half goes into bodies of Eigen's functions that a compiler
// instantiates at the end of a unit, for code that is never generated here.
#include "clang-tidy/ClangTidyCheck.h"
#include "clang-tidy/ClangTidyModule.h"
#include "clang-tidy/ClangTidyModuleRegistry.h"
#include "clang/AST/ASTContext.h"
#include "clang/ASTMatchers/ASTMatchFinder.h"
#include "clang/ASTMatchers/ASTMatchers.h"
#include "clang/Frontend/CompilerInstance.h"
#include "clang/Frontend/FrontendPluginRegistry.h"
#include "clang/Sema/Sema.h"
#include "clang/Sema/SemaConsumer.h"

namespace {

using clang::ast_matchers::MatchFinder;

// The whole unit is visited first: what then is to be visited of it is chosen here.
class OwnCode : public clang::tidy::ClangTidyCheck {
 public:
  using ClangTidyCheck::ClangTidyCheck;

  void registerMatchers(MatchFinder* finder) override {
    finder->addMatcher(clang::ast_matchers::translationUnitDecl().bind("unit"), this);
  }

  void check(const MatchFinder::MatchResult& result) override {
    const auto* unit = result.Nodes.getNodeAs<clang::TranslationUnitDecl>("unit");
    if (unit == nullptr) return;
    std::vector<clang::Decl*> own;
    for (clang::Decl* declaration : unit->decls()) {
      const clang::SourceLocation place = declaration->getLocation();
      if (place.isValid() && !result.SourceManager->isInSystemHeader(place))
        own.push_back(declaration);
    }
    result.Context->setTraversalScope(own);
  }
};

// What own code needs to be understood (types that are deduced, constants) is instantiated at once
// and never waits; what waits for the end of the unit are bodies that something else calls. Of
// types of this unit alone the bodies have to be here: their absence would be an error.
class OwnBodies : public clang::SemaConsumer {
 public:
  void InitializeSema(clang::Sema& sema) override { sema_ = &sema; }

  bool HandleTopLevelDecl(clang::DeclGroupRef /*declarations*/) override {
    if (sema_ == nullptr) return true;
    auto& waiting = sema_->PendingInstantiations;
    const clang::SourceManager& sources = sema_->getSourceManager();
    const auto foreign = [&](const clang::Sema::PendingImplicitInstantiation& one) {
      return one.first->isExternallyVisible() && sources.isInSystemHeader(one.first->getLocation());
    };
    waiting.erase(std::remove_if(waiting.begin(), waiting.end(), foreign), waiting.end());
    return true;
  }

 private:
  clang::Sema* sema_ = nullptr;
};

class OwnBodiesAction : public clang::PluginASTAction {
 protected:
  std::unique_ptr<clang::ASTConsumer> CreateASTConsumer(clang::CompilerInstance& /*compiler*/,
                                                        llvm::StringRef /*file*/) override {
    return std::make_unique<OwnBodies>();
  }
  bool ParseArgs(const clang::CompilerInstance& /*compiler*/,
                 const std::vector<std::string>& /*arguments*/) override {
    return true;
  }
  ActionType getActionType() override { return AddBeforeMainAction; }
};

class OwnCodeModule : public clang::tidy::ClangTidyModule {
 public:
  void addCheckFactories(clang::tidy::ClangTidyCheckFactories& factories) override {
    factories.registerCheck<OwnCode>("offnominal-own-code");
  }
};

const clang::tidy::ClangTidyModuleRegistry::Add<OwnCodeModule> kRegistered(
    "offnominal", "leaves system headers out");

const clang::FrontendPluginRegistry::Add<OwnBodiesAction> kBodies(
    "offnominal-own-bodies", "leaves bodies of system headers out");

}  // namespace
