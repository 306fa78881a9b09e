# loop_levels.R FOLDER: restricted likelihood by nlme of every FOLDER/*.csv, y ~ heat with random levels of cask, as a list
# of sd between levels, sd within, the slope over heat and its standard error. Writes FOLDER/lme.txt.
suppressPackageStartupMessages(library(nlme))
folder <- commandArgs(trailingOnly = TRUE)[1]
lines <- character()
for (path in sort(list.files(folder, "\\.csv$", full.names = TRUE))) {
  fit <- lme(y ~ heat, random = ~ 1 | cask, data = read.csv(path))
  sd <- as.numeric(VarCorr(fit)[, "StdDev"])
  lines <- c(lines, paste(basename(path), sd[1], sd[2], fixef(fit)[["heat"]], sqrt(vcov(fit)["heat", "heat"])))
}
writeLines(lines, file.path(folder, "lme.txt"))
